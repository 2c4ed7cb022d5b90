"""From a CasADi function to compiled C on many lanes: code generation, packing, compiler, cache, loader, threads."""
