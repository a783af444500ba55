"""CHOrD: a floor plan picture becomes a furnished, hierarchical OpenUSD house."""

__version__ = "0.1.0"
