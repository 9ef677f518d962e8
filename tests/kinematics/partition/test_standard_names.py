"""What a part is by its name: standards, words of several languages, sizes; and names that only hold such letters."""

from __future__ import annotations

import pytest

from kinform.kinematics.partition.standard_names import kind_by_name

SCREWS = """DIN 912 M3x10|DIN912-M3x10-8.8|din_912_m3|DIN EN ISO 4762 - M3 x 10|ISO 4762:2004|iso4762_m4x12|
GB/T 70.1-2000 M5|GB_T70.1|GB70-85 M3|gb／t 5783|ASME B18.3 #4-40|bench/GB/T 70.1|ANSI B18.3.1M|
ANSI/ASME B18.2.1|JIS B 1176 M3|jis_b1111|UNI 5931|ГОСТ 11738-84 М6|GOST 7798|DIN 7991|ISO 10642|
ISO 7380-1|DIN ISO 7380|DIN 933|DIN 931|ISO 4017|M3x10|m3x10_2|M2.5 x 6|M4x12 socket head cap|screw|
Screw3|hex_bolt_12|socket head cap screw|SHCS M3|Zylinderkopfschraube|Schrauben|
Sechskantschraube M6|Gewindestift|vis|vis CHC M3|vis à tête fraisée|tornillo M3|
tornillo cabeza hexagonal|vite|vite a testa cilindrica|parafuso|parafuso allen|skruv|skrue|schroef|
śruba|винт|Болт М6|螺钉|内六角螺钉M3x10|螺丝_3|螺栓|六角ボルト|ネジ|볼트|bearing screw|
motor_mount_screw|arm/base_plate_bolt_4|setScrew|cap screw"""
NUTS = """DIN 934 M3|DIN985|ISO 4032|iso_4032_m5|GB/T 6170|JIS B 1181|ASME B18.2.2|hex nut|locknut|
Sechskantmutter|Mutter M3|écrou|e\u0301crou|ecrou_m3|dado|tuerca|porca|гайка|螺母|ナット|너트|
motor mount nut"""
WASHERS = """DIN 125|DIN 125-A|DIN125A M3|ISO 7089|top/ISO 7089|GB/T 97.1|JIS B 1256|ASME B18.22.1|washer|
flat_washer_3|Unterlegscheibe_2|Federring|rondelle|arandela|arruela|шайба|垫圈|ワッシャ|DIN 9021"""
PINS = """ISO 8734|ISO 8734-4x20|DIN 7|DIN 6325|ISO 2338|GB/T 119.1|JIS B 1354|dowel|dowel pin|Zylinderstift|
goupille|штифт|圆柱销"""
CIRCLIPS = """DIN 471|DIN 471 - 10x1|DIN 472|din472_22|DIN 6799|GB/T 893.1|GB894.1|JIS B 2804|circlip|Seegerring|
e-clip|retaining ring|卡簧"""
RIVETS = """DIN 660|DIN 7337|ISO 15983|GB/T 867|rivet|Niete|remache|铆钉"""
BEARINGS = """608ZZ|608-2RS|608 zz|625-2Z|6800|6800ZZ|6001-2RS1|6806_2|MR105ZZ|F695ZZ|LM8UU|DIN 625|ISO 15|
GB/T 276|JIS B 1521|bearing|bearing_608|Kugellager|Rillenkugellager 6001|roulement|cuscinetto|
rodamiento|rolamento|подшипник|轴承|ベアリング|support bearing"""
NONE = """M3 bracket|vis-a-vis plate|vis à vis|screwdriver holder|screwdriver|nutcracker|bolted_plate|
washers_box|vise_jaw|pinion|DIN rail|DIN rail 35|iso view 4762x|bearing block|bearing_holder_608|
bearingless hub|Lagerbock|Riemenscheibe|Bremsscheibe|nut trap|bolt plate|screw holder|
holder for M3x10 screws|soporte rodamiento|palier roulement|轴承座|轴承盖|visor|division|television|
minute|donut|peanut|thunderbolt_logo|unscrew|pinhole|spine|スピンドル|spinner|spindle|M3|m3_hole|
part_608|608|arm_6800|box_m3x10_lid|garden 912|edin912|bracket DIN 912|6800_bracket|visite|dados|
coupling 10x25|M3x10 bracket|kugelgelenk|basin 125|isolator 7089|PIN code|gb 1024|frame 70.1"""


def _names(text):
    return [name.replace("\n", "") for name in text.split("|")]


EXPECTED = {
    "screw": SCREWS, "nut": NUTS, "washer": WASHERS, "pin": PINS, "circlip": CIRCLIPS, "rivet": RIVETS,
    "bearing": BEARINGS, None: NONE,
}  # fmt: skip


@pytest.mark.parametrize(("name", "kind"), [(name, kind) for kind, text in EXPECTED.items() for name in _names(text)])
def test_a_name_says_what_it_says_and_no_more(name, kind):
    found = kind_by_name(name)
    assert (found and found[0]) == kind, found
