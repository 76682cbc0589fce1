"""LaTeX to HTML by LaTeXML, one chapter at a time, so that chapters convert side by side and are cached.

LaTeXML works in two steps. The first turns LaTeX into XML; there we give
every thing that can be referred to its address and resolve all references,
since only we see the whole book. The second step turns that XML into HTML.
What a step made is kept beside a digest of what it was made from, and made
again only if that changed.
"""
import hashlib
import os
import re
import shutil
import subprocess
import xml.etree.ElementTree as ET

from problems import Problem, Problems

NAMESPACE = "http://dlmf.nist.gov/LaTeXML"
ET.register_namespace("", NAMESPACE)
SECTIONS = ("chapter", "section", "subsection", "subsubsection", "paragraph")
BEGIN = r"\documentclass{book}\usepackage{malus}\begin{document}"  # on the first line, which keeps its number
MESSAGE = re.compile(r"^(Warning|Error|Fatal):(.*)")
PLACE = re.compile(r"\.tex; (?:from )?line (\d+)")


def ours(name):
    return f"{{{NAMESPACE}}}{name}"


def slug(text):
    """Words joined by hyphens, as they may stand in an address."""
    return "-".join(re.findall(r"[a-z0-9]+", text.lower())) or "section"


def version(tool):
    """Changes when another LaTeXML is installed."""
    path = shutil.which(tool)
    if not path:
        raise Problem(tool, 0, "not found; Debian's package latexml brings it")
    status = os.stat(path)
    return f"{path} {status.st_size} {status.st_mtime_ns}"


def made_from(target, text, make):
    """Calls make() unless target was made from this very text."""
    digest = hashlib.sha256(text.encode()).hexdigest()
    key = target + ".key"
    if os.path.exists(target) and os.path.exists(key):
        with open(key, encoding="utf-8") as kept:
            if kept.read() == digest:
                return
    make()
    with open(key, "w", encoding="utf-8") as kept:
        kept.write(digest)


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


class Converter:
    """Runs LaTeXML in a directory of its own."""

    def __init__(self, work, theme):
        os.makedirs(work, exist_ok=True)
        self.work, self.theme = work, theme
        with open(os.path.join(theme, "malus.sty.ltxml"), encoding="utf-8") as binding:
            self.context = binding.read() + version("latexml") + version("latexmlpost")

    def path(self, name):
        return os.path.join(self.work, name)

    def run(self, source, log, command):
        """Every complaint of LaTeXML is a problem: of the chapter, at its line, since the lines are the chapter's."""
        done = subprocess.run(command, capture_output=True, text=True)
        with open(log, encoding="utf-8", errors="replace") as file:
            lines = file.read().splitlines()
        problems = []
        for i, line in enumerate(lines):
            if message := MESSAGE.match(line):
                place = PLACE.search(" ".join(lines[i:i + 3]))
                problems.append(Problem(source, int(place[1]) if place else 0, f"LaTeXML: {message[1]}:{message[2]}"))
        if done.returncode and not problems:
            problems.append(Problem(source, 0, done.stderr.strip() or f"{command[0]} gave {done.returncode}"))
        if problems:
            raise Problems(problems)

    def to_xml(self, name, source, latex, chapter):
        """First step: LaTeX of a chapter to the root of its XML; chapter is its number, 0 for none."""
        text = f"{BEGIN}\\setcounter{{chapter}}{{{max(chapter - 1, 0)}}}{latex}\n\\end{{document}}\n"
        tex, xml, log = self.path(name + ".tex"), self.path(name + ".xml"), self.path(name + ".log")

        def make():
            write(tex, text)
            self.run(source, log, ["latexml", "--quiet", f"--path={self.theme}", f"--log={log}",
                                   f"--destination={xml}", tex])

        made_from(xml, text + self.context, make)
        return ET.parse(xml).getroot()

    def to_html(self, name, source, root):
        """Second step: XML to the HTML of the chapter's body."""
        text = ET.tostring(root, encoding="unicode")
        xml, page, log = self.path(name + ".ref.xml"), self.path(name + ".html"), self.path(name + ".post.log")

        def make():
            write(xml, text)
            self.run(source, log, ["latexmlpost", "--quiet", "--format=html5", "--pmml", "--novalidate", "--noscan",
                                   "--nocrossref", "--noindex", "--nographicimages", "--nodefaultresources",
                                   "--timestamp=0", f"--log={log}", f"--destination={page}", xml])

        made_from(page, text + self.context, make)
        with open(page, encoding="utf-8") as file:
            return re.search(r'<article class="ltx_document">\n?(.*)</article>', file.read(), re.DOTALL)[1]


def number_of(element):
    """The number LaTeX gave it, or the tag the author gave it."""
    for tag in element.iterfind(f"{ours('tags')}/{ours('tag')}"):
        if tag.get("role") == "refnum":
            return "".join(tag.itertext()).strip()
    return ""


def words(title):
    """The words of a title, without its number and its formulas."""
    if title is None:
        return ""
    parts = [title.text or ""]
    for child in title:
        if child.tag not in (ours("tag"), ours("Math")):
            parts.append(words(child))
        parts.append(child.tail or "")
    return "".join(parts)


def give_addresses(root):
    """Names what can be linked to in this chapter; returns {label: (anchor, number, kind)}."""
    labels, taken = {}, set()
    for element in root.iter():
        kind = element.tag.removeprefix(f"{{{NAMESPACE}}}")
        names = [name.removeprefix("LABEL:") for name in element.get("labels", "").split()]
        if names:
            anchor = names[0]
        elif kind in SECTIONS:
            anchor = slug(words(element.find(ours("title"))))
        elif kind == "p" and element.get("class", "").startswith("lit-entry"):
            anchor = element.get("{http://www.w3.org/XML/1998/namespace}id")
        else:
            continue
        while anchor in taken:
            anchor += "-again"
        taken.add(anchor)
        element.set("fragid", anchor)
        for name in names:
            labels[name] = (anchor, number_of(element), kind)
    return labels


def link(element, href, text, title):
    """Makes an element a link."""
    element.tag = ours("ref")
    tail = element.tail
    element.clear()
    element.text, element.tail = text, tail
    element.set("href", href)
    if title:
        element.set("title", title)


def resolve(root, address, citation):
    """Replaces references by links. address(label) and citation(key) give (href, text, title)."""
    for element in list(root.iter(ours("ref"))):
        if name := element.get("labelref"):
            link(element, *address(name.removeprefix("LABEL:")))
    for parent in list(root.iter()):
        for bibref in parent.findall(ours("bibref")):
            place, tail = list(parent).index(bibref), bibref.tail
            parent.remove(bibref)
            keys = bibref.get("bibrefs").split(",")
            for i, key in enumerate(keys):
                cited = ET.Element(ours("ref"))
                link(cited, *citation(key))
                cited.tail = ", " if i + 1 < len(keys) else tail
                parent.insert(place + i, cited)
