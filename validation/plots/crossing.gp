# X.thermal: DoLP of the bar of copper and paint at four hours (crossing.csv): panels as in images.gp.
pictures = 'crossing'
load style[1:strlen(style) - strlen('style.gp')] . 'images.gp'
