"""Which parts move as one, from the intended joints and the contacts of all parts (`[function] complete = true`).

Contact that no stated joint moves holds. So each pair of parts that touch is asked, joint by joint, whether it may part
(`parting`): its patches must leave that joint's motion free, and what it costs to part it says how likely it is meant
to: little for a face or a journal that goes round the axis, much for screw holes that line up. All parts then get the
body, one of those that the joints name, that makes the sum of what is parted least (`labelling`): one cut where the
joints are a tree, and a multiway cut where they close loops. By how much the next best body of a part is dearer is its
margin (`margins`): parts that could go either way are listed, with what holds them.

A hinge of two leaves with a pin in both, which no joint names: leaf_a ~ pin is a journal about the stated axis, price
40, and so is leaf_b ~ pin. In either leaf the pin costs the journal of the other: its margin is 0, so it is listed.

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
