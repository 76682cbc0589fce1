# DoLP with source and viewer interchanged, for three diffuse terms.
width = 760
load style
set xrange [0:90]; set xtics 15; set xlabel 'one zenith; the other is 5 deg [deg]'
set ylabel 'DoLP'
set key top left Left reverse
plot 'interchange.csv' using 'angle_deg':'thesis' with lines linetype 1 title 'thesis: light from 5 deg', \
     '' using 'angle_deg':'thesis_interchanged' with lines linetype 2 title 'thesis: seen at 5 deg', \
     '' using 'angle_deg':'reciprocal' with lines linetype 3 title 'reciprocal, both ways', \
     '' using 'angle_deg':'facets' with lines linetype 7 title 'facets alone, both ways'
