"""What the joints of an assembly let move: how much, which ways, how far, and what they hold too often.

The counts, relative to ground (`mechanism` tells how they are found, with a four-bar as example;
`kinematics.mechanism_results` puts all of them together):

- instantaneous: dimension of the joint rates that close all loops. `named_freedoms` is a readable basis of them.
- finite: of these, how many are motions over a distance (`finite_motion`, block by block by `local_dimension`, which
  steps from closed poses and closes the loops again). None where it could not be decided.
- idle: turns of single bodies that nobody sees, as of a bolt or a roller (`idle`, by shapes that `revolution` knows);
  effective: all others.
- redundant: equations of the loops that others say already; `loop_redundancy` and, for the contacts of a single
  joint, `joint_redundancy` say which joints hold what more than once.
- blocked: what is left where the patches that block joints count too.

Ratios: `couplings` reads them out of the motions that contacts along teeth and cams leave, `teeth` sees whether they
last, and `stated_couplings` are those that only the function states."""
