"""Places: where a box may stand in a room, and what keeps it from there. Metres.

free_places  floor on which nothing stands; places near a piece
taken_space  boxes with reasons and heights
room_space   reasons: pieces and their fronts, casings, floor that openings keep clear
wall_frames  sides of rooms: frames along them, free spans, boxes with the back to them
tries        places to try: beside a piece, over the floor, around a place
free_ways    ways that stay open with a thing on the floor
swept        volumes that doors, drawers and leaves of appliances sweep
"""
