#!/usr/bin/env python3
"""Set this project up in .venv and run it. Needs Python 3.11 or newer with pip, and nothing else.

    python3 run.py                    set up, then `rightside verify`, which ends with the report's path
    python3 run.py prove -k voter     the same set-up, then any command of `rightside`
    python3 run.py test               the same set-up, then ruff, mypy and all tests
    python3 run.py test -k voter      the same set-up, then pytest with these arguments

The first run downloads about 340 MB; later ones start at once. RIGHTSIDE_VENV names another folder than .venv.
"""

import hashlib
import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

if sys.version_info < (3, 11):  # noqa: UP036 - any Python may be asked to start this file
    found = ", ".join(filter(shutil.which, ["python3.14", "python3.13", "python3.12", "python3.11"])) or "none here"
    sys.exit(f"run.py needs Python 3.11 or newer, this is {sys.version.split()[0]}; newer ones on the path: {found}")

ROOT = Path(__file__).resolve().parent
VENV = ROOT / os.environ.get("RIGHTSIDE_VENV", ".venv")
SCRIPTS, PACKAGES = (sysconfig.get_path(kind, "venv", {"base": str(VENV)}) for kind in ("scripts", "purelib"))
STAMP = VENV / "rightside-stamp"
CHECKS = ["ruff", "check"], ["ruff", "format", "--check"], ["mypy"], ["pytest", "-n", "auto"]


def say(text):
    print(f"run.py: {text}", file=sys.stderr, flush=True)


def stop(text):
    say(text)
    sys.exit(2)


def program(name):
    return shutil.which(name, path=SCRIPTS)


def call(*command, **settings):
    code = subprocess.run(command, cwd=ROOT, **settings).returncode
    return code if code >= 0 else 128 - code


def origin():
    """What .venv is made from: another interpreter, another place or another project text asks for another .venv."""
    kernel = sorted(path.relative_to(ROOT) for path in ROOT.glob("safety/trees/kernel/*.py"))  # compiled when installed
    texts = [(ROOT / name).read_bytes() for name in ("pyproject.toml", "hatch_build.py", *kernel)]
    return hashlib.sha256(b"\0".join([sys.implementation.cache_tag.encode(), bytes(VENV), *texts])).hexdigest()


def make_venv():
    made = subprocess.run([sys.executable, "-m", "venv", "--clear", VENV], capture_output=True, text=True)
    if made.returncode == 0:
        return
    say("Python's own venv does not work here, most likely for want of ensurepip; trying virtualenv")
    with tempfile.TemporaryDirectory() as tools:
        virtualenv = [sys.executable, "-m", "virtualenv", "--quiet", "--clear", str(VENV)]
        if (
            call(sys.executable, "-m", "pip", "install", "--quiet", "--target", tools, "virtualenv") != 0
            or call(*virtualenv, env={**os.environ, "PYTHONPATH": tools}) != 0
        ):
            say((made.stdout + made.stderr).strip())
            stop("neither venv nor virtualenv works; on Debian or Ubuntu `apt install python3-venv`, then run again")


def set_up():
    """Make .venv anew and install into it. The stamp comes last, so that an interrupted set-up starts over."""
    if VENV != ROOT / ".venv" and VENV.exists() and any(VENV.iterdir()) and not (VENV / "pyvenv.cfg").exists():
        stop(f"{VENV} holds something else than a virtual environment; set RIGHTSIDE_VENV to another folder")
    say(f"making {VENV} with Python {sys.version.split()[0]}")
    STAMP.unlink(missing_ok=True)
    make_venv()
    say("installing rightside and what it needs; the first time this takes a minute or two")
    if call(program("python"), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-e", ".[test]") != 0:
        say("pip could not install the project; its reason stands above. Put that right and run this again.")
        stop("Without a network: set PIP_NO_INDEX=1 and PIP_FIND_LINKS to a folder of wheels, hatchling included.")
    STAMP.write_text(origin())


def main(arguments):
    if arguments[:1] in (["-h"], ["--help"]):
        print(__doc__)
        return 0
    if not (program("python") and program("rightside") and STAMP.exists() and STAMP.read_text() == origin()):
        set_up()
    if Path(PACKAGES, "safety").exists():  # ours is imported from the project; one here would hide it
        say(f"two distributions own the package `safety`: the one in {PACKAGES} is not ours, most likely the scanner.")
        stop(f"Remove it and run this again: {program('python')} -m pip uninstall safety")
    signal.signal(signal.SIGINT, lambda *_: None)  # from here on Ctrl-C is for the child, which keeps partial results
    if arguments[:1] != ["test"]:
        verb = [] if arguments and not arguments[0].startswith("-") else ["verify"]
        return call(program("rightside"), *verb, *arguments)
    checks = [["pytest", *arguments[1:]]] if arguments[1:] else CHECKS
    codes = {" ".join(check): call(program("python"), "-m", *check) for check in checks}
    failed = [f"{check} (exit {code})" for check, code in codes.items() if code != 0]
    say(f"failed: {', '.join(failed)}" if failed else "all passed")
    return max(codes.values())


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except KeyboardInterrupt:
        say("interrupted; the next run starts the set-up over")
        sys.exit(130)
