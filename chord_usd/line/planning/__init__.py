"""Words or an open plan -> Plan: how rooms come to be where nobody has drawn them."""
