"""crosstrace: one scene through independent ray tracers, every differing pixel explained."""
