"""Where many starts lead: attractors with their shares and basins, section maps, and bifurcation
diagrams with coexisting attractors.
"""
