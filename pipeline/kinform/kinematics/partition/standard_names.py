"""Standard parts by name: words of catalogues in several languages, numbers of standards, sizes of screws and bearings.

A name is split at everything that is no letter or digit, and where a capital follows a small letter. Of "bearing screw"
the last word that is known says what it is; a name with a word for what holds, covers or carries such a part ("bearing
block") is none. Of a number only what stands after the letters of a standard counts; a size ("M3x10") or a bearing's
designation only where nothing else is said but finish, grade and count.
"""

from __future__ import annotations

import re
import unicodedata
from itertools import pairwise
from typing import Literal

__all__ = ["STANDARDS", "WORDS", "kind_by_name"]

StandardKind = Literal["screw", "nut", "washer", "pin", "circlip", "rivet", "bearing", "ball"]

WORDS: dict[StandardKind, str] = {
    "screw": "screw screws bolt bolts capscrew setscrew grubscrew machinescrew shcs bhcs fhcs schraube "
    "schrauben gewindestift gewindestifte vis vite viti tornillo tornillos perno pernos parafuso parafusos "
    "skruv skruvar skrue skruer schroef schroeven ruuvi sroub śruba sruba wkręt wkret vint винт винты болт "
    "болты",
    "nut": "nut nuts hexnut locknut mutter muttern ecrou ecrous écrou écrous dado dadi tuerca tuercas porca "
    "porcas moer moeren nakretka nakrętka гайка гайки",
    "washer": "washer washers scheibe scheiben federring federringe rondelle rondelles rondella rosetta arandela "
    "arandelas arruela arruelas anilha bricka brickor podkładka podkladka шайба шайбы",
    "pin": "dowel dowels dowelpin springpin splitpin rollpin clevispin stift zylinderstift passstift "
    "spannstift goupille goupilles spina pasador pasadores kołek kolek штифт штифты шплинт",
    "rivet": "rivet rivets niet niete nieten rivetto rivetti remache remaches rebite rebites nit заклепка заклёпка",
    "circlip": "circlip circlips seeger seegerring sicherungsring sicherungsringe eclip snapring retainingring",
    "ball": "kugel kugeln bille billes sfera",
    "bearing": "bearing bearings lager kugellager wälzlager waelzlager roulement roulements cuscinetto cuscinetti "
    "rodamiento rodamientos rolamento rolamentos łożysko lozysko подшипник подшипники",
}
"""Words of names, by kind; pairs of words are written as one."""
ENDINGS: dict[str, StandardKind] = {
    "schraube": "screw", "schrauben": "screw", "mutter": "nut", "muttern": "nut", "unterlegscheibe": "washer",
    "federscheibe": "washer", "zahnscheibe": "washer", "fächerscheibe": "washer", "zylinderstift": "pin",
    "kerbstift": "pin", "kugellager": "bearing", "nadellager": "bearing", "rollenlager": "bearing",
}  # fmt: skip
"""How compounds end that are such parts."""
WRITTEN_TOGETHER: dict[str, StandardKind] = {
    "螺钉": "screw", "螺丝": "screw", "螺栓": "screw", "螺絲": "screw", "螺釘": "screw", "ネジ": "screw",
    "ねじ": "screw", "ボルト": "screw", "나사": "screw", "볼트": "screw", "螺母": "nut", "螺帽": "nut",
    "ナット": "nut", "너트": "nut", "垫圈": "washer", "垫片": "washer", "墊圈": "washer", "ワッシャ": "washer",
    "座金": "washer", "와셔": "washer", "销": "pin", "铆钉": "rivet", "リベット": "rivet", "卡簧": "circlip",
    "挡圈": "circlip", "止め輪": "circlip", "钢球": "ball", "轴承": "bearing", "軸承": "bearing",
    "ベアリング": "bearing", "軸受": "bearing", "베어링": "bearing",
}  # fmt: skip
"""The same in scripts that put no spaces."""
HOLDERS_OF = frozenset(
    "holder holders block blocks housing mount mounts plate plates bracket brackets cover covers carrier carriers seat "
    "seats support supports trap traps box case guide retainer adapter adaptor driver gauge gage terminal pocket hole "
    "holes knob tray rack organizer organiser clamp puller press spanner wrench key jig template lid base "
    "halter träger traeger platte deckel gehäuse gehaeuse bock sitz halterung schlüssel aufnahme "
    "supporto piastra coperchio soporte placa tapa carcasa plaque boitier boîtier logement palier suporte tampa "
    "alloggiamento корпус крышка держатель".split()
)
"""Words of parts that hold, cover or carry such parts, or are made for them."""
HOLDERS_BEFORE = frozenset(
    "supporto piastra coperchio soporte placa tapa carcasa plaque boitier boîtier logement palier suporte tampa "
    "alloggiamento корпус крышка держатель".split()
)
"""Those that come first in their languages."""
OF = frozenset("for of für fuer".split())
"""After one of the others, what follows is what it holds: "holder for screws"."""
HELD_TOGETHER = "座盖蓋壳殼架箱板套"
"""Signs that say the same after such a word."""
BESIDE = frozenset(
    "a2 a4 ss zn steel stainless black zinc brass nylon inox stahl verzinkt din iso copy x mm hex socket head cap pan "
    "countersunk button flat hexagon torx phillips shielded sealed c3 left right top bottom front rear".split()
)
"""Words beside a size or a designation that say nothing of what else a part may be."""
STANDARDS: dict[StandardKind, str] = {
    "screw": "din84 din85 din912 din913 din914 din915 din916 din931 din933 din963 din965 din6912 din7380 "
    "din7500 din7984 din7985 din7991 din603 din653 din464 iso1207 iso1580 iso2009 iso4014 iso4017 iso4026 "
    "iso4027 iso4028 iso4029 iso4762 iso7045 iso7046 iso7047 iso7380 iso10642 iso14579 iso14580 iso14583 "
    "iso8676 iso8765 gb65 gb67 gb68 gb70 gb77 gb78 gb79 gb80 gb818 gb819 gb823 gb5780 gb5781 gb5782 gb5783 "
    "gb5785 gb845 jis1111 jis1176 jis1177 jis1180 jis1174 asme18.3 asme18.2.1 asme18.6.3 asme18.5 uni5931 "
    "uni5933 uni5737 uni5739 gost11738 gost7798 gost7805 gost17473 gost17475 gost1491",
    "nut": "din439 din555 din557 din562 din934 din936 din980 din982 din985 din1587 din6923 iso4032 iso4033 "
    "iso4034 iso4035 iso7040 iso7042 iso10511 iso4161 gb41 gb889 gb6170 gb6172 gb6175 gb6187 jis1181 "
    "asme18.2.2 uni5588 gost5915 gost5927",
    "washer": "din125 din126 din127 din128 din137 din433 din440 din6796 din6797 din6798 din7349 din9021 iso7089 "
    "iso7090 iso7091 iso7092 iso7093 iso7094 iso8738 gb93 gb95 gb96 gb97 gb848 gb859 gb862 jis1256 jis1251 "
    "asme18.22 asme18.21 uni6592 gost11371 gost6402",
    "pin": "din1 din7 din94 din1481 din6325 din7343 din7346 din7979 iso1234 iso2338 iso2339 iso2340 iso2341 "
    "iso8733 iso8734 iso8735 iso8752 iso13337 gb91 gb117 gb119 gb120 gb879 jis1354 jis1355 jis2808 asme18.8 "
    "gost3128 gost397",
    "circlip": "din471 din472 din6799 din5417 gb893 gb894 gb896 jis2804 jis2805 asme18.27 gost13942 gost13943",
    "rivet": "din660 din661 din7337 din7338 iso1051 iso15973 iso15977 iso15983 gb867 gb869 gb12618 gost10299",
    "bearing": "din616 din625 din628 din630 din711 din720 din5412 din617 iso15 iso104 gb276 gb292 gb297 gb301 "
    "jis1521 gost8338 gost7242",
}
"""Numbers of standards, by kind: those of GB, JIS and GOST without their parts."""
_KIND_OF = {word: kind for kind, words in WORDS.items() for word in words.split()}
_KIND_OF_NUMBER = {number: kind for kind, numbers in STANDARDS.items() for number in numbers.split()}
_NUMBER = re.compile(
    r"(?<![^\W\d_])(din|iso|gb|jis|asme|ansi|uni|gost|гост)"
    r"((?:[\W_]*(?:en|iso|t|b)(?![^\W\d_]))*)[\W_]*(\d+(?:\.\d+)*)"
)
_SIZE = re.compile(r"m\d+(?:[.,]\d+)?[x×*]\d+(?:[.,]\d+)?(?:[x×*]\d+(?:[.,]\d+)?)?")
_BEARING = re.compile(
    r"(?:(?:f|s|mf|smf|mr|r)?6[0-9]{2}|f?mr\d{2,3}|6[02389]\d{2}|1[69]0\d{2}|7[029]\d{2}|5?2?3[02]\d{2})"
    r"(?:2rs1?|2rsh|2z|zz|rs|vv|dd|uu|ddu|llu|llb)|lm\d{1,2}l?uu|(?:6[02389]|7[02])\d{2}"
)
_GB_T = re.compile(r"\bgb/t(?![^\W\d_])", re.IGNORECASE)
"""Whose stroke parts no path."""
_VIS_A_VIS = re.compile(r"vis[\W_]*[aà][\W_]*vis")


def kind_by_name(name: str) -> tuple[StandardKind, str] | None:
    """What a part is by its name (the last of a path), and the words that say so; None where it says nothing."""
    leaf = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", _GB_T.sub("gb ", unicodedata.normalize("NFKC", name)).rsplit("/", 1)[-1])
    low = _VIS_A_VIS.sub(" ", leaf.lower())
    words = [word for word in re.split(r"[\W_]+", low) if word]
    bare = [word.rstrip("0123456789") or word for word in words]
    first = min((k for k, word in enumerate(bare) if word in HOLDERS_BEFORE), default=len(bare))
    last = max((k for k, word in enumerate(bare) if word in HOLDERS_OF), default=-1)
    if any(word in HOLDERS_OF and then in OF for word, then in pairwise(bare)):
        return None
    for found in _NUMBER.finditer(low):
        kind = _KIND_OF_NUMBER.get(_standard(*found.groups()))
        if kind is not None and last < 0:
            return kind, f"named {found[1].upper()} {found[3]}"
    together = [(low.rfind(word), kind, word) for word, kind in WRITTEN_TOGETHER.items() if word in low]
    if together:
        at, kind, word = max(together)
        return None if low[at + len(word) : at + len(word) + 1] in set(HELD_TOGETHER) else (kind, f"named '{word}'")
    for k in reversed(range(len(bare))):
        for word in (bare[k], words[k], "".join(bare[k : k + 2])):
            kind = _KIND_OF.get(word) or next((ENDINGS[end] for end in ENDINGS if word.endswith(end)), None)
            if kind is not None:
                return (kind, f"named '{word}'") if last <= k < first else None
    return _by_size(low)


def _standard(body: str, between: str, number: str) -> str:
    """The key of a standard: a number of ISO after other letters is one of ISO."""
    if body in ("asme", "ansi"):
        parts = number.split(".")
        two, three = ("asme" + ".".join(parts[:count]) for count in (2, 3))
        return three if three in _KIND_OF_NUMBER else two
    main = number.split(".")[0]
    iso = "iso" in between and f"iso{main}" in _KIND_OF_NUMBER
    return f"{'iso' if iso else 'gost' if body == 'гост' else body}{main}"


def _by_size(low: str) -> tuple[StandardKind, str] | None:
    """A size of a screw, or a bearing's designation, beside words only that say nothing else."""
    joined = re.sub(r"(?<=\d)\s*[x×*]\s*(?=\d)", "x", low)
    sized: tuple[tuple[re.Pattern[str], StandardKind], ...] = ((_SIZE, "screw"), (_BEARING, "bearing"))
    for pattern, kind in sized:
        compact = re.sub(r"(?<=\d)[-_ ](?=2?(?:rs[1h]?|z|zz|vv|dd|uu)\b)", "", joined)
        words = [word for word in re.split(r"[^\w.,×*]+|_", compact) if word]
        sizes = [word for word in words if pattern.fullmatch(word)]
        rest = [word for word in words if word not in sizes]
        if sizes and all(word in BESIDE or re.fullmatch(r"\d{1,2}(?:[.,]\d+)?", word) for word in rest):
            return kind, f"named '{sizes[0]}'"
    return None
