"""Matplotlib's SVG as fewer bytes: the same picture, to a hundredth of a point."""

from __future__ import annotations

import itertools
import re
import xml.etree.ElementTree as ET

SVG = "http://www.w3.org/2000/svg"
HREF = "{http://www.w3.org/1999/xlink}href"
POINTS = {"M": 1, "L": 1, "Q": 2, "C": 3}  # of a path's commands
GLYPH_SCALE = "scale(0.015625)"  # matplotlib draws glyphs in 64ths
COARSER = 16  # of those are enough

TAG = {name: f"{{{SVG}}}{name}" for name in ("svg", "g", "defs", "path", "use")}

ET.register_namespace("", SVG)


def compact(svg: str, prefix: str, letters: dict[str, str] | None = None) -> str:
    """The same picture in fewer bytes; its ids become `prefix` and a number.

    Parameters
    ----------
    svg : str
        An ``<svg>`` element as `ddlib.figures.style` writes it; one that went through here
        before is returned as it is.
    prefix : str
        Different for each picture of a page.
    letters : dict, optional
        Outlines of letters that earlier pictures of the page define, and their ids: they are
        used here, not defined again. Those of this picture are added.
    """
    letters = {} if letters is None else letters
    root = ET.fromstring(svg)
    if root.attrib.pop("version", None) is None:  # matplotlib writes one
        return svg
    rename(root, prefix)
    glyphs = {e.get("id") for e in root.iter(TAG["path"]) if e.get("transform") == GLYPH_SCALE}
    for element in root.iter():
        element.text = (element.text or "").strip() or None
        element.tail = None
        shorten(element, glyphs)
    share(root, glyphs, letters)
    prune(root)
    inherit(root)
    for key in ("clip-path", "style"):
        gather(root, key)
    return ET.tostring(root, encoding="unicode").replace(" />", "/>")


def rename(root: ET.Element, prefix: str) -> None:
    """Short names for the ids that something refers to; the others go."""
    text = ET.tostring(root, encoding="unicode")
    used = re.findall(r'href="#([^"]*)"|url\(#([^)]*)\)', text)
    names = {a or b: f"{prefix}-{k}" for k, (a, b) in enumerate(dict.fromkeys(used))}
    for element in root.iter():
        name = element.attrib.pop("id", None)
        if name in names:
            element.set("id", names[name])
        target = element.attrib.pop(HREF, None) or element.get("href")
        if target:
            element.set("href", "#" + names[target[1:]])
        for key, value in element.items():
            if "url(#" in value:  # also within a style
                element.set(key, re.sub(r"(?<=url\(#)[^)]*", lambda old: names[old[0]], value))


def shorten(element: ET.Element, glyphs: set[str]) -> None:
    """Shorter ways to write a path, a style and a place."""
    get, put = element.get, element.set
    if get("id") in glyphs and "d" in element.attrib:
        put("d", relative(get("d"), 0, 1 / COARSER))
        put("transform", f"scale({COARSER / 64:g})")
    elif "d" in element.attrib:
        put("d", relative(get("d"), 2))
    if "style" in element.attrib and element.tag != TAG["svg"]:
        put("style", re.sub(r"\s*([:;])\s*", r"\1", get("style")))
    if element.tag == TAG["use"]:
        moved = re.fullmatch(r"translate\(([-\d.e]+) 0\)", get("transform", ""))
        if moved and get("href", "")[1:] in glyphs:
            del element.attrib["transform"]
            put("x", moved[1])
        digits = 0 if get("href", "")[1:] in glyphs else 2
        for key in {"x", "y"} & set(element.keys()):
            put(key, plain(round(float(get(key)), digits)))
    if "transform" in element.attrib:
        put("transform", re.sub(r"-?\d+\.\d{3,}", rounded, get("transform")))


def share(root: ET.Element, glyphs: set[str], letters: dict[str, str]) -> None:
    """Draw each letter by its first definition on the page; spaces are not drawn at all."""
    known = {}
    for path in root.iter(TAG["path"]):
        if path.get("id") in glyphs:
            outline = path.get("d")
            known[path.get("id")] = letters.setdefault(outline, path.get("id")) if outline else ""
    for parent in root.iter():
        for child in list(parent):
            own, shown = child.get("id"), child.get("href", "")[1:]
            if known.get(own, own) != own or known.get(shown) == "":
                parent.remove(child)
            elif shown in known:
                child.set("href", "#" + known[shown])


def rounded(number: re.Match) -> str:
    """Places to hundredths; what is small is a scale and keeps its digits."""
    value = float(number[0])
    return plain(round(value, 2)) if abs(value) > 1 else f"{value:.6g}"


def plain(value: float) -> str:
    """A number as SVG needs it: no trailing zeros, no leading one."""
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return re.sub(r"^(-?)0\.", r"\1.", text) if text not in {"-0", ""} else "0"


def relative(path: str, digits: int, factor: float = 1.0) -> str:
    """A path in relative coordinates, rounded so that errors do not add up.

    Parameters
    ----------
    path : str
        The attribute ``d`` with the absolute commands that matplotlib writes: M, L, Q, C, z.
        A path with others is returned as it is.
    digits : int
        Decimals that are kept.
    factor : float
        Multiplies all coordinates.
    """
    if re.search(r"[a-yABD-KNOPR-Z]", path):
        return path
    pieces, here, start, last = [], (0.0, 0.0), (0.0, 0.0), ""
    for command, numbers in re.findall(r"([MLQCz])([^MLQCz]*)", path):
        if command == "z":
            pieces.append("z")
            here, last = start, "z"
            continue
        values = [round(factor * float(number), digits) for number in numbers.split()]
        step = 2 * POINTS[command]
        for k in range(0, len(values), step):
            points = list(zip(values[k : k + step : 2], values[k + 1 : k + step : 2]))
            letter, moves = shortest(command, points, here)
            if not pieces:
                letter = "M"
            repeats = letter == last != "m" or (last, letter) == ("m", "l")
            pieces.append(("" if repeats else letter) + joined(moves, repeats))
            here, last = points[-1], letter
            if command == "M":
                start, command = here, "L"  # what follows a move are lines
    return "".join(pieces)


def shortest(command: str, points: list[tuple], here: tuple) -> tuple[str, list[float]]:
    """A command and its numbers, as seen from where the pen is."""
    moves = [(x - here[0], y - here[1]) for x, y in points]
    if command == "L" and moves[0][1] == 0:
        return "h", [moves[0][0]]
    if command == "L" and moves[0][0] == 0:
        return "v", [moves[0][1]]
    return command.lower(), [value for move in moves for value in move]


def joined(values: list[float], after_number: bool) -> str:
    """Numbers side by side, with a space only where a minus sign does not part them."""
    text = ""
    for value in map(plain, values):
        text += (" " if (text or after_number) and not value.startswith("-") else "") + value
    return text


def prune(root: ET.Element) -> None:
    """Take out what is not seen: groups that say nothing, shapes without fill and stroke."""
    for element in list(root.iter()):
        element[:] = [inner for child in element for inner in flat(child)]


def flat(element: ET.Element) -> list[ET.Element]:
    """An element, or what is in it where it is a group without attributes."""
    unseen = element.tag == TAG["path"] and element.get("style") == "fill:none"
    if unseen or (element.tag in (TAG["g"], TAG["defs"]) and len(element) == 0):
        return []
    if element.tag == TAG["g"] and not element.attrib:
        return [inner for child in element for inner in flat(child)]
    return [element]


def inherit(root: ET.Element) -> None:
    """Leave out of a ``use`` what the element it shows sets itself."""
    own = {e.get("id"): e.get("style", "").split(";") for e in root.iter() if "id" in e.keys()}
    for element in root.iter(TAG["use"]):
        given = element.attrib.pop("style", "").split(";")
        left = [item for item in given if item and item not in own.get(element.get("href")[1:], ())]
        if left:
            element.set("style", ";".join(left))


def gather(parent: ET.Element, key: str) -> None:
    """Say once, on a group, what neighbours have in common."""
    children, parent[:] = list(parent), []
    for value, run in itertools.groupby(children, lambda child: shared(child, key)):
        run = list(run)
        if value and len(run) > 1:
            group = ET.SubElement(parent, TAG["g"], {key: value})
            for child in run:
                del child.attrib[key]
            group.extend(run)
        else:
            parent.extend(run)
    for child in parent:
        if child.tag == TAG["g"]:
            gather(child, key)


def shared(element: ET.Element, key: str) -> str | None:
    """An attribute that means the same on a group around the element."""
    value = element.get(key)
    if key == "style":  # opacity works on a group as a whole
        return None if value and re.search(r"(^|;)opacity:", value) else value
    return value if element.tag == TAG["path"] and "transform" not in element.keys() else None
