"""Joint axes made exactly consistent across the assembly, by no more than they are uncertain.

Each pair was decided alone, with axes as well as its fits know them. A loop is rigid to the rank of its closure where
axes that should be parallel differ by a rounding. So what agrees within its uncertainty is made to agree: directions
and lines (`snapping`), lines that meet (`concurrence`), sides of four-bars (`equal_lengths`), the proportions of
overconstrained loops (`proportions`), and the contacts of teeth and cams with the joints around them (`higher_pairs`).
No axis is moved by more than the alignment and its own uncertainty allow, both (`bounds`); what was moved is the misfit
(`misfit`)."""
