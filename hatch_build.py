"""Build hook: the wheel carries models/ and proofs/ as the scaffold that `rightside init` copies."""

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class Scaffold(BuildHookInterface):
    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if version != "standard":  # an editable install reads both folders where they are
            return
        for folder in ("models", "proofs"):
            build_data["force_include"][str(Path(self.root, folder))] = f"safety/_scaffold/{folder}"
