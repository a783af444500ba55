"""Vector files -> Plan: SVG, DXF, IFC, Sweet Home 3D. One file per format, `assemble` for all."""
