# X.paint: white paint of all thicknesses (coats.csv), and how light from inside is polarised (body.csv).
width = 900; height = 400
load style
set multiplot
set tmargin at screen 0.88; set bmargin at screen 0.21
set lmargin at screen 0.08; set rmargin at screen 0.47
set title 'reflectance of the body, straight down'
set logscale x; set xrange [0.1:500]; set xtics (0.1, 1, 10, 100)
set xlabel 'thickness [µm]'
set yrange [0:1]; set ytics 0.2
set key bottom right Left reverse samplen 2
plot 'coats.csv' using 'thickness_um':'over white' with lines linetype 2 title 'over white', \
     '' using 'thickness_um':'over black' with lines linetype 1 title 'over black', \
     '' using 'thickness_um':'stained over black' with lines linetype 3 title 'k = 0.001'
set lmargin at screen 0.57; set rmargin at screen 0.97
set title 'polarisation of light from inside'
unset logscale x; set xrange [0:90]; set xtics 30
set xlabel 'view zenith [deg]'
set yrange [0:0.6]; set ytics 0.1
set key top left Left reverse
plot 'body.csv' using 'view_deg':'dark' with lines linetype 2 title 'dark', \
     '' using 'view_deg':'white' with lines linetype 1 title 'white', \
     '' using 'view_deg':'face' with lines linetype 7 title 'the face alone, |T_1|/T_0'
unset multiplot
