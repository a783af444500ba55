"""File or drawing -> Plan -> PlanImage."""
