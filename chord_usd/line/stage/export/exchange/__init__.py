"""A house for programs that know no USD: buildings (IFC), drawings (DXF), maps for robots."""
