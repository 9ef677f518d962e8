"""What comes apart: contact pushes and does not pull.

`constraint_matrix` is J, a row for each sample that bounds a patch, of which J V ≥ 0 keeps parts from penetrating.
`contact_rows` are its rows pair by pair; `cone` decides which motions they allow, which is more than those that keep
contact. `releases` says how a pair comes apart, `separations` what can leave the whole assembly, alone or together, and
`lifting` shows quickly that a body can slide away.
"""
