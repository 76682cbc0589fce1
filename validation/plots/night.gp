# X.emission: the chunky bar at night (night.csv): panels as in images.gp.
pictures = 'night'
load style[1:strlen(style) - strlen('style.gp')] . 'images.gp'
