"""What writers of robot descriptions share.

`robot_model` makes links, joints, shapes and limits of an export model; `chains` makes joints of one freedom each of
those that have several. `write_back` writes the description that a design was read from, with `xml_edits` in its text.
"""
