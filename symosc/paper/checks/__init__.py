"""One function per claim: it computes the evidence and the verdict that follows from it."""
