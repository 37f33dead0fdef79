"""Build hook: the wheel carries models/ and proofs/ as the scaffold that `rightside init` copies, and the tree kernel.

    python hatch_build.py             compile the kernel in place, for work on it
    python hatch_build.py diagram     only this file of it

Without a C compiler the build goes on, and the kernel runs interpreted.
"""

import binascii
import sys
import sysconfig
import tempfile
import warnings
from pathlib import Path
from typing import Any

try:
    from hatchling.builders.hooks.plugin.interface import BuildHookInterface
except ModuleNotFoundError:  # run by hand
    BuildHookInterface = object  # type: ignore[assignment,misc]

ROOT = Path(__file__).resolve().parent
KERNEL = ROOT / "safety" / "trees" / "kernel"
FLAGS = ["-O3", "-g0", "-fno-math-errno", "-ffp-contract=off", "-w"] if sys.platform != "win32" else []


class Scaffold(BuildHookInterface):
    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        compiled = compile_kernel()
        if version != "standard":  # an editable install reads everything where it is
            return
        for folder in ("models", "proofs"):
            build_data["force_include"][str(ROOT / folder)] = f"safety/_scaffold/{folder}"
        for path in compiled:
            build_data["force_include"][str(path)] = path.relative_to(ROOT).as_posix()
        if compiled:
            build_data["pure_python"], build_data["infer_tag"] = False, True


def compile_kernel(*stems: str) -> list[Path]:
    """Compile every Cython file of the kernel, or those named; what was made, nothing where that cannot be done."""
    sources = [path for path in sorted(KERNEL.glob("*.py")) if path.read_text().startswith("# cython:")]
    try:
        return [compile_file(path) for path in sources if not stems or path.stem in stems]
    except Exception as error:  # no compiler, no headers, no Cython: whatever it is, the interpreted form works
        for path in [found for source in sources if not stems or source.stem in stems
                     for found in KERNEL.glob(f"_{source.stem}_c.*")]:  # fmt: skip
            path.unlink()
        warnings.warn(f"the fault-tree kernel is not compiled and runs interpreted, slowly: {error}", stacklevel=2)
        return []


def compile_file(source: Path) -> Path:
    """Compile one file under the name `_STEM_c`, with the hash of its text inside."""
    from Cython.Build import cythonize
    from setuptools import Distribution, Extension

    name = f"_{source.stem}_c"
    target = KERNEL / (name + sysconfig.get_config_var("EXT_SUFFIX"))
    text = source.read_bytes()
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, f"{name}.py")
        copy.write_bytes(text + f"\nSOURCE = {binascii.crc32(text)}\n".encode())
        extension = Extension(name, [str(copy)], extra_compile_args=FLAGS)
        modules = cythonize([extension], language_level=3, quiet=True, build_dir=folder)
        command = Distribution({"ext_modules": modules}).get_command_obj("build_ext")
        command.build_lib = command.build_temp = folder
        command.ensure_finalized()
        command.run()
        built = next(Path(folder).rglob(f"{name}*{Path(target).suffix}"))
        fresh = target.with_suffix(target.suffix + ".new")
        fresh.write_bytes(built.read_bytes())
        fresh.replace(target)  # at once: who reads it has the old one or the new one
    return target


if __name__ == "__main__":
    for path in compile_kernel(*sys.argv[1:]):
        print(path.relative_to(ROOT))
