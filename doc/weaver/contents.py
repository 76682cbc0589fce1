"""The volumes of the book, their parts, and the chapters of each, as doc/book/book.ini lists them.

A part names its chapters in the order in which they are read, floor/Name, each with a sentence about it if the
chapter's first sentence is not one. A part may also take the rest of some floors: what no part names, in the order
of the command line, so that a new chapter has a place before anybody gives it one.
"""
import configparser
import os
from collections.abc import Sequence

from problems import Problem


class Part:
    """A part: the name of its page, its title, what it is about, and the keys of its chapters."""

    def __init__(self, name: str, section: configparser.SectionProxy) -> None:
        self.name, self.title, self.about = name, section["title"], section["about"]
        self.volume = section.getint("volume")
        self.code = section.get("code", "whole")  # on paper: whole, or only the interface
        self.sentences: dict[str, str] = {}  # chapter -> a sentence about it, "" if its own first sentence is one
        for line in section.get("chapters", "").split("\n"):
            if chapter := line.strip():
                key, _, sentence = chapter.partition(" ")
                self.sentences[key] = sentence.strip()
        self.rest = section.get("rest", "").split()  # floors


class Volume:
    """A volume: its number, its title, and what it is about."""

    def __init__(self, number: int, section: configparser.SectionProxy) -> None:
        self.number, self.title, self.about = number, section["title"], section["about"]
        self.most_pages = section.getint("pages", 0)  # on paper; 0: as many as it takes
        self.run_in = section.get("chapters") == "run in"  # on paper, a chapter begins where the last ends


class Contents:
    """The whole of book.ini."""

    def __init__(self, path: str) -> None:
        self.path = path
        about = configparser.ConfigParser(interpolation=None)
        about.optionxform = str  # type: ignore[assignment]
        about.read(path, encoding="utf-8")
        self.about = about["book"]
        self.volumes = [Volume(int(name.split()[1]), about[name]) for name in about.sections() if name.startswith("volume ")]
        lines = [line.strip() for line in about["path"]["chapters"].split("\n") if line.strip()]
        self.readers_path = [line.partition(" ")[::2] for line in lines]  # chapters for a first reader, and what each is read for
        others = [name for name in about.sections() if name not in ("book", "path") and not name.startswith("volume ")]
        self.parts = sorted((Part(name, about[name]) for name in others), key=lambda part: part.volume)
        self.homes: dict[str, Part] = {}
        for part in self.parts:
            for key in part.sentences:
                if key in self.homes:
                    raise Problem(path, 0, f"{key} is in the parts {self.homes[key].name} and {part.name}")
                self.homes[key] = part
        self.floors = {floor: part for part in self.parts for floor in part.rest}

    def home(self, chapter: str) -> Part | None:
        """The part of a chapter; none for what is before the first part and behind the last."""
        if part := self.homes.get(chapter):
            return part
        floor = chapter.split("/", maxsplit=1)[0]
        if floor in ("front", "back"):
            return None
        if floor not in self.floors:
            raise Problem(self.path, 0, f"no part names the chapter {chapter}, and none takes the rest of {floor}")
        return self.floors[floor]

    def sentence(self, chapter: str) -> str:
        """The sentence about a chapter, if its own first sentence does not describe it."""
        part = self.homes.get(chapter)
        return part.sentences[chapter] if part else ""

    def ordered(self, paths: Sequence[str]) -> list[str]:
        """The files of the chapters in the order in which they are read."""
        def place(path: str) -> tuple[int, int]:
            key = key_of(path)
            if part := self.home(key):
                inside = list(part.sentences)
                return self.parts.index(part), inside.index(key) if key in inside else len(inside)
            return (-1 if key.startswith("front/") else len(self.parts)), 0
        return sorted(dict.fromkeys(paths), key=place)


def key_of(path: str) -> str:
    """How book.ini calls a chapter: light/Fresnel."""
    return "/".join(os.path.splitext(path)[0].split(os.sep)[-2:])
