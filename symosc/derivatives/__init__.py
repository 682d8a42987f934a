"""Derivatives of motions: of every event and state, by all numbers of an oscillator and its law."""
