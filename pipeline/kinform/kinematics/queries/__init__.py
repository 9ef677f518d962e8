"""Questions of users about freedoms and joints, answered from what was derived.

`motion_query` whether one motion is there, by `motion_senses` also one way only; `intended_freedoms` the same of all
that the function states; `joint_insight` why a joint is what it is; `through_helpers` how two bodies move by way of
loose parts; `adrift` which bodies count as free though they overlap with the rest; `afloat` which parts have play
between two others, and may carry them."""
