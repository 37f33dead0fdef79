"""The native engine: batches of injections on vector code compiled for the processor at hand."""

from safety.inject.native.engine import NativeEngine

__all__ = ["NativeEngine"]
