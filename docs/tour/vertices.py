#!/usr/bin/python3
"""A program of somebody else: the largest distance from a vertex of A to its nearest vertex of B.
It is no bound of h(A,B) at all."""

import sys

import numpy as np
from scipy.spatial import cKDTree


def vertices(name: str) -> np.ndarray:
    with open(name, encoding="ascii") as file:
        words = file.read().split()
    count = int(words[1])
    return np.array(words[4 : 4 + 3 * count], dtype=float).reshape(count, 3)


print("distance", cKDTree(vertices(sys.argv[2])).query(vertices(sys.argv[1]))[0].max())
