"""Which parts move as one, from the stated joints and the contacts of all parts (`[function] complete = true`).

Contact that no stated joint separates is rigid. `split_prices` asks of each pair of parts that touch, joint by joint,
whether the joint may separate them: their patches must leave its motion free. The price says how unlikely that is: low
for a face or a journal about the axis, high for screw holes that line up (`contact`). `graph` makes the graph of parts,
prices and named parts, and `label_merging` decides which names stand for one body. `labelling` then gives every part
the body that makes the sum of separated prices least: one cut where the joints are a tree, a multiway cut where they
close loops. The margin of a part is how much more the next best body costs; parts with a small margin are listed, with
what holds them (`bodies`).

A hinge of two leaves with a pin in both, which no joint names: leaf_a ~ pin is a journal about the stated axis, price
40, and so is leaf_b ~ pin. In either leaf the pin costs the journal of the other: its margin is 0, so it is listed.

Joints that name one side or none are completed first (`missing_sides`, from `candidate_splits`). Without a function,
`proposals` looks for joints that may be meant; with one, `undeclared_joints` looks for those that it leaves out.

The method is a multiway cut as an integer program (Boykov, Veksler, Zabih 2001 for the energy; solved by HiGHS).
"""

from kinform.kinematics.partition.bodies import Partition, partition
from kinform.kinematics.partition.missing_sides import find_missing_sides
from kinform.kinematics.partition.proposals import Proposal, propose, proposed_joints, stated_proposals
from kinform.kinematics.partition.undeclared_joints import undeclared_joints

__all__ = [
    "Partition",
    "Proposal",
    "find_missing_sides",
    "partition",
    "propose",
    "proposed_joints",
    "stated_proposals",
    "undeclared_joints",
]
