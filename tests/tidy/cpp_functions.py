"""Finds the functions of a C++ source by its braces, well enough to measure them."""

import re

RAW_STRING = re.compile(r'R"([^()\\ ]{0,16})\(.*?\)\1"', re.DOTALL)
COMMENT = r"//[^\n]*|/\*.*?\*/"
STRING = r'"(?:\\.|[^"\\\n])*"'
CHARACTER = r"(?<![0-9a-zA-Z_])'(?:\\.|[^'\\\n])+'"
NOT_CODE = re.compile("|".join((COMMENT, STRING, CHARACTER)), re.DOTALL)
SCOPE = re.compile(r'^(?:(?:typedef|static|inline|constexpr|const)\b\s*|\[\[.*?\]\]\s*)*'
                   r'(?:namespace|class|struct|union|enum|extern)\b')
LABEL = re.compile(r'^(?:\s*(?:public|private|protected)\s*:)+')


def _blank(match):
    """The same number of lines, and nothing on them but a pair of quotes where a string stood."""
    text = match.group(0)
    return ('""' if text[0] in "\"R'" else "") + "\n" * text.count("\n")


def strip(text):
    """Code without comments, literals and preprocessor lines; of #if ... #else the first branch."""
    text = NOT_CODE.sub(_blank, RAW_STRING.sub(_blank, text))
    kept, branches, continued = [], [], False
    for line in text.split("\n"):
        bare = line.strip()
        if continued or bare.startswith("#"):
            if not continued:
                word = bare[1:].strip()
                if word.startswith("if"):
                    branches.append(False)
                elif word.startswith("el") and branches:
                    branches[-1] = True
                elif word.startswith("endif") and branches:
                    branches.pop()
            continued = bare.endswith("\\")
            kept.append("")
        else:
            kept.append("" if any(branches) else line)
    return "\n".join(kept)


def _without_template(header):
    """The header after its template<...> parameters."""
    header = LABEL.sub("", header).strip()
    while header.startswith("template"):
        depth = 0
        for i, c in enumerate(header):
            depth += {"<": 1, ">": -1}.get(c, 0)
            if c == ">" and depth == 0:
                header = header[i + 1:].strip()
                break
        else:
            break
    return header


def _kind(header, inside):
    """What a brace after `header` opens: a scope, a function, or something inside an expression."""
    if inside == "function" or header.count("(") != header.count(")"):
        return "other"
    header = _without_template(header)
    if SCOPE.match(header):
        return "scope"
    if "(" not in header or header.endswith("="):
        return "other"
    return "other" if re.search(r"[,:]\s*[\w:<>]+$", header) else "function"


def functions(text):
    """(first line, last line, header) of each function; a lambda counts as part of its function."""
    found, stack, header, line = [], [], "", 1
    header_line = None
    for c in strip(text):
        if c == "\n":
            line += 1
        if c == "{":
            inside = stack[-1][0] if stack else "scope"
            kind = "other" if inside == "other" else _kind(header, inside)
            kind = "function" if inside == "function" else kind
            outermost = kind == "function" and inside != "function"
            stack.append((kind, outermost, header, header_line))
            header, header_line = "", None
        elif c == "}":
            if not stack:
                return found
            kind, outermost, opened, opened_line = stack.pop()
            if outermost:
                found.append((opened_line, line, " ".join(_without_template(opened).split())))
            header, header_line = (opened + "{}", opened_line) if kind == "other" else ("", None)
        elif c == ";" and header.count("(") == header.count(")"):
            header, header_line = "", None
        else:
            if header_line is None and not c.isspace():
                header_line = line
            header += c
    return found
