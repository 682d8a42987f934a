"""Grazing: Theorem 7's windows (`window`), and the motions that lead to a graze (`start`, `curve`,
`solve`).

backward goes back in time from a tangency to where the flow came from. check compares Theorem 7
with numerics: a way of deciding a graze is a method of `Ways` there, with a name in
`WHY_UNDECIDED`.
"""
