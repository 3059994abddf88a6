"""Every solver on every mesh of the packages and the same with even edges."""

from analysis.corpus.every_mesh import make

__all__ = ["make"]
