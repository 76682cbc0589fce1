# X.paint: glass with films of magnesium fluoride: films.csv over wavelength, films-angle.csv over the angle at 550 nm.
width = 900; height = 380
load style
set multiplot
set tmargin at screen 0.88; set bmargin at screen 0.21
set lmargin at screen 0.09; set rmargin at screen 0.48
set title 'straight down'
set xrange [400:700]; set xlabel 'wavelength [nm]'
set yrange [0:0.07]; set ytics 0.01; set ylabel 'reflectance'
set key top right
plot 'films.csv' using 'wavelength_nm':'bare' with lines title 'bare glass', \
     '' using 'wavelength_nm':'quarter wave' with lines title 'quarter wave at 550 nm', \
     '' using 'wavelength_nm':'2 um' with lines title '2 µm of the same'
set lmargin at screen 0.58; set rmargin at screen 0.97
set title 'at 550 nm'
set xrange [0:90]; set xtics 30; set xlabel 'angle of incidence [deg]'
set yrange [0:0.3]; set ytics 0.1; unset ylabel
set key top left Left reverse samplen 2
plot 'films-angle.csv' using 'zenith_deg':'bare_s' with lines linetype 1 title 'bare, s', \
     '' using 'zenith_deg':'bare_p' with lines linetype 7 title 'bare, p', \
     '' using 'zenith_deg':'film_s' with lines linetype 2 title 'quarter wave, s', \
     '' using 'zenith_deg':'film_p' with lines linetype 4 title 'quarter wave, p'
unset multiplot
