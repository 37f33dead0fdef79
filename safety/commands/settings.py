"""Parameters as users set them: on the command line for what is worked on, in pyproject.toml for the whole project.

A setting of pyproject.toml goes to the models that have such a parameter and leaves the others alone; one on the
command line has to fit a model that is worked on.  A name that no model has is refused, and so is a value that a
parameter does not take.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from safety.commands import CommandError
from safety.commands.evaluate import fitting, has_parameter
from safety.model import Model
from safety.project import Project, Value, setting_place
from safety.system import ModelError, nearest
from safety.tracing import parameters, resolve, trace


def check(project: Project, models: Sequence[type[Model]], given: Mapping[str, Value]) -> None:
    """Refuse names and values of settings; `models` are worked on, `given` stands on the command line.

    Raises CommandError that says where the setting stands.
    """
    together = {**project.config.settings, **given}
    for name in project.config.settings:
        if name not in given:
            _check_one(project, models, name, together, f"{setting_place(project.root, name)}: setting {name}")
    for name in given:
        if models and not any(has_parameter(model, name) for model in models):
            raise CommandError(f"--set: {min(_refusals(models, name), key=_helps)}")
        _check_one(project, models, name, together, "--set")


def _check_one(
    project: Project, models: Sequence[type[Model]], name: str, together: Mapping[str, Value], place: str
) -> None:
    hit = [model for model in models if has_parameter(model, name)]
    if not hit and not _known(project, name):
        paths = {path for model in project.models.values() for path, _ in parameters(model)}
        known = paths | {path.rpartition(".")[2] for path in paths}
        raise CommandError(f"{place}: no model of the project has a parameter {name!r}; {nearest(name, known)}")
    for model in hit:
        try:
            trace(model, {name: together[name]})
        except ModelError as error:
            if not _fits_with_others(model, together):
                raise CommandError(f"{place}: {error}") from None


def _fits_with_others(model: type[Model], together: Mapping[str, Value]) -> bool:
    """Whether the model takes all of its settings, some of which make no sense alone."""
    try:
        trace(model, fitting(model, together))
    except ModelError:
        return False
    return True


def _known(project: Project, name: str) -> bool:
    """Whether any model of the project has such a parameter; all of models/ is loaded only where it has to be."""
    if not any(has_parameter(model, name) for model in project.models.values()):
        project.load_models()
    return any(has_parameter(model, name) for model in project.models.values())


def _refusals(models: Iterable[type[Model]], name: str) -> Iterable[str]:
    for model in models:
        try:
            resolve(model, {name: None})
        except ModelError as error:
            yield str(error)


def _helps(message: str) -> tuple[Any, ...]:
    return "did you mean" not in message, len(message)
