#!/usr/bin/env python3
"""Holds the pages that lib/docs/pages makes to the public headers: each has its page, and what it
declares stands there with its own comment. site_test.py SITE"""
import html
import os
import re
import sys
import unittest

TOP = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
SITE = os.path.abspath(sys.argv.pop(1))
API = os.path.join(SITE, "api")

# In a header that clang-format has seen, what stands in column 0 stands in the namespace.
TYPE = re.compile(r"^(?:class|struct|enum class) (?:\[\[nodiscard\]\] |WELLGYRO_EXPORT )?(\w+)[^;]*\{",
                  re.M)
OTHER = re.compile(r"^(?:using (\w+) =|typedef struct \w+ (\w+);|\} (\w+);"
                   r"|inline constexpr [\w:]+ (\w+) ="
                   r"|(?:WELLGYRO_EXPORT|WELLGYRO_C|constexpr|inline) [\w:<>*& ]*?(\w+)\()", re.M)


def Text(*path):
    with open(os.path.join(*path), encoding="utf-8") as file:
        return file.read()


def Plain(page):
    """The page's words, without tags."""
    return html.unescape(re.sub(r"<[^>]*>", " ", page))


def Words(text):
    return " ".join(re.findall(r"\w+", text))


def Headers():
    """Of each as it is included: its text."""
    listed = re.findall(r"^wellgyro\S* (\S+)$", Text(TOP, "lib", "public-headers.txt"), re.M)
    texts = {f"wellgyro/{name}": Text(TOP, "lib", "wellgyro", name) for name in listed}
    return texts | {"wellgyro.h": Text(TOP, "lib", "capi", "wellgyro.h")}


def Linked(page):
    """Of what a page of the reference leads to: its file."""
    links = re.findall(r'<a class="el" href="([\w.]+\.html)[^"]*">([^<]*)</a>', page)
    return {html.unescape(text).split("<")[0]: file for file, text in links}


def Pages():
    return [name for name in sorted(os.listdir(API)) if name.endswith(".html")]


class Site(unittest.TestCase):
    def test_every_public_header_has_its_page_and_no_other(self):
        links = Linked(Text(API, "index.html"))
        self.assertEqual(sorted(links), sorted(Headers()))
        self.assertEqual(len({*links.values()}), len(links))
        self.assertEqual({*links.values()}, {name for name in Pages() if name.endswith("_8h.html")})

    def test_what_a_header_declares_is_on_its_page(self):
        links, count, problems = Linked(Text(API, "index.html")), 0, []
        for header, text in Headers().items():
            page = Text(API, links[header])
            words = set(re.findall(r"\w+", Plain(page)))
            types = TYPE.findall(text)
            others = [name for found in OTHER.findall(text) for name in found if name]
            problems += [f"{header}: no {name}" for name in types + others if name not in words]
            problems += [f"{header}: {name} has no page" for name in types
                         if f"enum class {name} " not in text and name not in Linked(page)]
            count += len(types + others)
        self.assertFalse(problems, "\n".join(problems))
        self.assertGreater(count, 150)

    def test_a_comment_behind_a_declaration_stands_beside_its_name(self):
        """That of several names beside each."""
        beside = set()
        for name in Pages():
            page = Text(API, name)
            rows = re.findall(r'<tr class="memitem:\w+">(.*?)</tr>\s*<tr class="memdesc:\w+">(.*?)</tr>',
                              page, re.S)
            rows += re.findall(r'<td class="fieldname">(.*?)</td><td class="fielddoc">(.*?)</td>',
                               page, re.S)
            beside |= {(word, Words(Plain(comment).removesuffix("More...")))
                       for item, comment in rows for word in re.findall(r"\w+", Plain(item))}
        count, problems = 0, []
        for header, text in Headers().items():
            for declared, comment in re.findall(r"^  (?! )([^/\n]*[,;]) +///< (.*)", text, re.M):
                names = re.findall(r"\b(\w+\b(?<!_))(?:\[\w+\]|\{\}| = [^,;]*)?[,;]", declared)
                for name in names if "(" not in declared.split(" = ")[0] else []:
                    count += 1
                    said = Words(Plain(comment.replace("`", "")))
                    if (name, said) not in beside:
                        problems.append(f"{header}: {name}: {said}")
        self.assertFalse(problems, "\n".join(problems))
        self.assertGreater(count, 250)

    def test_types_in_declarations_lead_to_their_pages(self):
        types = {name for text in Headers().values() for name in TYPE.findall(text)}
        for name in (name for name in Pages() if name.endswith("_8h.html")):
            for row in re.findall(r'<tr class="memitem:\w+">(.*?)</tr>', Text(API, name), re.S):
                rest = re.sub(r"=[^,)]*", "", Plain(re.sub(r"<(a|b)\b.*?</\1>", "", row)))
                self.assertEqual(types & set(re.findall(r"\w+", rest)), set(), name)

    def test_formulas_and_diagrams_keep_their_lines(self):
        shown = {" ".join(html.unescape(re.sub(r"<[^>]*>", "", line)).split())
                 for name in Pages() for line in re.findall(r'<div class="line">(.*?)</div>',
                                                            Text(API, name))}
        lines = [line for text in Headers().values()
                 for block in re.findall(r"^/// ```\n(.*?)^/// ```$", text, re.M | re.S)
                 for line in block.splitlines()]
        self.assertGreater(len(lines), 5)
        for line in lines:
            self.assertIn(" ".join(line.removeprefix("///").split()), shown)

    def test_it_is_reached_from_every_page_and_leads_back(self):
        pages = [name for name in os.listdir(SITE) if name.endswith(".html")]
        self.assertGreater(len(pages), 8)
        for name in pages:
            self.assertRegex(Text(SITE, name), r'href="[./]*api/index\.html"', name)
        self.assertIn("../index.html", Text(API, "menudata.js"))

    def test_nothing_is_loaded_from_elsewhere(self):
        count = 0
        for folder, _, names in os.walk(SITE):
            for name in (name for name in names if name.endswith(".html")):
                loads = re.findall(r"<(?:script|link|img|iframe)\b[^>]*(?:src|href)=\"([^\"]*)\"",
                                   Text(folder, name))
                count += len(loads)
                self.assertEqual([load for load in loads if "//" in load], [], name)
        self.assertGreater(count, 500)


if __name__ == "__main__":
    unittest.main()
