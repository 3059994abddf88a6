"""Every solver on every mesh of the packages and its half."""

from analysis.corpus.every_mesh import make

__all__ = ["make"]
