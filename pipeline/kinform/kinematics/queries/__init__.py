"""What users ask about freedoms and joints, answered from the derived kinematics.

`motion_query`: is one motion there, between two bodies and in the whole assembly; `motion_senses` decides it for each
sense. `intended_freedoms`: the same for every joint that the function states. `joint_insight`: why a joint is what it
is. `disconnected`: bodies that count as free although they interpenetrate others. `design_view` is what all of these
take. Questions that only rules ask are in `consistency.questions`.
"""
