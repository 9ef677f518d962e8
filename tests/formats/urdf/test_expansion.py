"""Expansion gives the bytes that xacro gives, and reads no file but those that it is handed."""

from __future__ import annotations

import os
import random
import types

import pytest

xacro = pytest.importorskip("xacro", reason="xacro expands xacro: pip install 'kinform[xacro]'")

from kinform.errors import InputError  # noqa: E402
from kinform.form.problems import Problems  # noqa: E402
from kinform.formats.description.mesh_files import MeshFiles  # noqa: E402
from kinform.formats.urdf.reading import expansion  # noqa: E402
from kinform.formats.urdf.reading import xacro as reading  # noqa: E402
from kinform.formats.urdf.reading.expressions import Budget, NotAllowed  # noqa: E402
from kinform.foundation.processes import in_own_process  # noqa: E402

SPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
FEATURES = f"""<?xml version="1.0" encoding="latin-1"?>
<robot name="r" {SPACE}>
  <!-- gone with the property -->
  <xacro:property name="w" value="0.5"/> <xacro:property name="n" value="${{w * 2}}"/>
  <xacro:property name="lazy" value="${{later + 1}}"/><xacro:property name="later" value="3"/>
  <xacro:property name="text" value="'1.0'"/><xacro:property name="c" value="${{xacro.load_yaml('data.yaml')}}"/>
  <xacro:property name="e" default="7"/><xacro:property name="e" default="8"/><xacro:property name="gone" value="1"/>
  <xacro:property name="gone" remove="true"/><xacro:arg name="size" default="${{2 * n}}"/>
  <xacro:property name="block"><b x="${{w}}"/><b/></xacro:property><xacro:property name="turn" value="${{radians}}"/>
  <xacro:macro name="m" params="p q:=5 r:='a b' s:=${{w + 1}} *inner **outer t:=^|9 w:=^">
    <l p="${{p}}" q="${{q}}" r="${{r}}" s="${{s}}" t="${{t}}" w="${{w}}"><xacro:insert_block name="inner"/></l>
    <xacro:insert_block name="outer"/><xacro:property name="up" value="${{p}}" scope="parent"/></xacro:macro>
  <xacro:m p="1"><i a="${{n}}"/><o><i/><i/></o></xacro:m> <xacro:call macro="${{'m'}}" p="x"><i/><o/></xacro:call>
  <xacro:if value="${{w &lt; 1 and not 0}}"><y/></xacro:if><xacro:unless value="${{$(arg size) - 2}}"><z/></xacro:unless>
  <v a="$(arg size)" b="$(eval size * 2)" c="$${{w}}" d="$$(arg x)" e="${{text}}" f="${{[w, 'a']}}" g="a${{1}}b${{2.0}}"/>
  <v h="${{c['a'].b[0]}}" i="${{c.list[1].k}}" j="${{c['u']}}" k="${{up}}" l="${{lazy}}" m="${{e}}" n="${{turn(180)}}"/>
  <v o="${{1e-7}}" p="${{10**20}}" q="${{2/3}}" r="${{True}}" s="${{'%.3f' % w}}" t="${{xacro.arg('size')}}" u="${{-0.0}}"/>
  <xacro:include filename="more.xacro" ns="ns"/><xacro:include filename="absent.xacro" optional="true"/>
  <xacro:include filename="part*.xacro"/><v a="${{ns.x + 1}}" xacro:b="1"/><xacro:ns.made k="2"/><xacro:insert_block name="block"/>
  <xacro:element xacro:name="${{'el'}}" a="1"/><h><xacro:attribute name="at" value="a${{w}}"/></h>
  <!-- kept ${{w}} --><!-- xacro:eval-comments --><!-- ${{w}} -->text ${{w}} &amp; é <![CDATA[<${{n}}>]]>
  <xacro:if value="${{len(xacro.tokenize('a b,c')) == 3}}"><k a="${{max(map(len, ['a', 'bb']))}}"/></xacro:if>
</robot>
"""  # noqa: E501
BESIDE = {
    "data.yaml": "a: {b: [1.5, 2]}\nlist: [0, {k: v}]\nu: !degrees 90\n",
    "more.xacro": f'<r {SPACE} xmlns:q="x"><xacro:property name="x" value="4"/>'
    '<xacro:macro name="made" params="k"><made k="${k + x}"/></xacro:macro></r>',
    "part1.xacro": f"<r {SPACE}>\r\n<one/></r>",
    "part2.xacro": "<r><two/></r>",
}


def host(folder, text, **beside):
    (folder / ".git").mkdir(exist_ok=True)
    for name, content in {**BESIDE, **beside}.items():
        (folder / name).write_text(content, newline="")
    path = folder / "r.urdf.xacro"
    path.write_text(text)
    return reading._Host(path, path.read_bytes(), path.name, Problems(), MeshFiles(path, {}))


def of_upstream(path):
    def silent():
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        return reading._in_the_fork(path)

    return in_own_process(silent)


def test_features_expand_to_the_same_bytes(tmp_path):
    asked = host(tmp_path, FEATURES)
    ours, theirs = asked.expanded(), of_upstream(asked.path)
    assert ours.text == theirs.text and "2.0" in ours.text
    assert {os.path.basename(name) for name in ours.includes} == set(BESIDE)


WRONG = ("${1 +}", "${nothing}", "${1/0}", "$(arg none)", "$(none x)", "$(dirname)", "${[][1]}", "${", "${'a' + 1}",
         "${xacro.fatal('bad')}", "${xacro.load_yaml('absent.yaml')}",
         "${int('x')}", "$(find no_such_package)")  # fmt: skip


@pytest.mark.parametrize("text", WRONG)
def test_both_refuse(tmp_path, text):
    asked = host(tmp_path, f'<robot name="r" {SPACE}><link name="{text}"/></robot>')
    assert isinstance(asked.expanded(), reading._Fault) and isinstance(of_upstream(asked.path), reading._Fault)


def test_parameters_of_macros_are_parted_as_by_xacro():
    draw = random.Random(1)
    pieces = (
        "a",
        "b:=",
        "=",
        ":=",
        "^",
        "^|",
        "'",
        '"',
        "x",
        " ",
        "  ",
        "${",
        "}",
        "$(",
        ")",
        "1.5",
        "*b",
        "\n",
        "'q r'",
    )
    for _ in range(3000):
        text = "p" + "".join(draw.choices(pieces, k=draw.randint(1, 9)))
        assert expansion.first_parameter(text, Budget()) == xacro.parse_macro_arg(text), text


def test_parameters_that_take_exponential_time_are_bounded():
    with pytest.raises(NotAllowed):
        expansion.first_parameter("a:=" + "''" * 500 + '"', Budget(10_000))


def test_names_are_valid_as_for_xacro():
    valid = expansion._Expansion(xacro, "", b"", lambda question: b"").is_valid_name
    for name in (
        "a",
        "_a",
        "é",
        "ﬁ",
        "1a",
        "a b",
        "a.b",
        "if",
        "match",
        "True",
        "",
        " a",
        "a\n",
        "a;b",
        "(a)",
        "print",
    ):
        assert valid(name) == xacro.is_valid_name(name), name


def test_what_has_no_end_is_refused(tmp_path):
    grow = "".join(f'<xacro:property name="p{k + 1}" value="${{p{k}}}${{p{k}}}"/>' for k in range(40))
    nested = "".join(f'<xacro:property name="p{k + 1}" value="${{[p{k}, p{k}]}}"/>' for k in range(40))
    for body in (
        f'<xacro:property name="p0" value="text"/>{grow}<link name="${{p40}}"/>',
        f'<xacro:property name="p0" value="${{[0]}}"/>{nested}<link name="${{p40}}"/>',
        "<a/>" * 11_000,
        '<xacro:include filename="r.urdf.xacro"/>',
    ):
        assert isinstance(host(tmp_path, f'<robot name="r" {SPACE}>{body}</robot>').expanded(), reading._Fault)


def test_a_xacro_with_other_internals_is_refused(monkeypatch):
    assert expansion.unfit(xacro) is None

    def eval_text(text, symbols, more):
        """A function with another parameter."""

    monkeypatch.setattr(xacro, "eval_text", eval_text)
    assert expansion.unfit(xacro)
    monkeypatch.undo()
    grabbed = types.FunctionType(compile("def f(): return eval('1')", "", "exec").co_consts[0], {"__name__": "xacro"})
    monkeypatch.setattr(xacro, "grab_macro", grabbed)
    assert expansion.unfit(xacro)
    monkeypatch.undo()
    monkeypatch.delattr(xacro, "safe_eval")
    assert expansion.unfit(xacro)


def test_nothing_of_xacro_is_left_changed(tmp_path):
    before = dict(vars(xacro))
    asked = host(tmp_path, FEATURES)
    expansion.expand(str(asked.path), asked.data, asked.answer)  # here, as where nothing can fork
    assert {name for name in before if vars(xacro)[name] is not before[name]} <= {"filestack"}


OUTSIDE = ("../secret.xacro", "linked.xacro", "out/secret.xacro", "../*.xacro", "out/*.xacro",
           "part*/../../secret.xacro",
           "link*.xacro", "/etc/hostname", "$(find etc)/hostname", "$(find out)/secret.xacro", "${'../secret.xacro'}",
           "out/../secret.xacro")  # fmt: skip


@pytest.mark.parametrize("name", OUTSIDE)
def test_files_outside_of_the_design_are_refused(tmp_path, name):
    (tmp_path / "secret.xacro").write_text("<r><leaked/></r>")
    folder = tmp_path / "design"
    folder.mkdir()
    (folder / "linked.xacro").symlink_to(tmp_path / "secret.xacro")
    (folder / "out").symlink_to(tmp_path)
    for optional in ("false", "true"):
        body = f'\n<xacro:include filename="{name}" optional="{optional}"/><link name="a"/>'
        asked = host(folder, f'<robot name="r" {SPACE}>{body}</robot>')
        done = asked.expanded()
        assert isinstance(done, reading._Fault) and done.remedy
        assert not any("secret" in read for read in asked.texts)
        loaded = host(folder, f'<robot name="r" {SPACE}><link name="${{xacro.load_yaml({name!r})}}"/></robot>')
        if "$" not in name and "*" not in name:
            assert isinstance(loaded.expanded(), reading._Fault)
    problems = Problems()
    assert reading.read(asked.path, asked.data, "r.urdf.xacro", problems, asked.meshes) is None
    with pytest.raises(InputError) as caught:
        problems.raise_if_any()
    assert caught.value.problems[0].line in (1, 2) and caught.value.problems[0].remedy


def test_entities_of_included_files_are_refused(tmp_path):
    entity = '<!DOCTYPE r [<!ENTITY a "b">]><r>&a;</r>'
    asked = host(tmp_path, f'<robot name="r" {SPACE}><xacro:include filename="part1.xacro"/></robot>',
                 **{"part1.xacro": entity})  # fmt: skip
    assert isinstance(asked.expanded(), reading._Fault) and len(asked.problems) == 1
