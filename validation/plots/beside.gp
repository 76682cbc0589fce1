# The thesis's sampling, ours at the same number of rays, and the reference (beside.csv): panels as in images.gp.
pictures = 'beside'
load style[1:strlen(style) - strlen('style.gp')] . 'images.gp'
