# Figure 7.36: DoLP against the angle from the sun, 700 nm, 3.4 km (scan.csv; with aerosol aerosol.csv).
width = 820
load style
set xrange [0:150]; set xtics 30; set yrange [0:1]
set xlabel 'angle from the sun [deg]'; set ylabel 'DoLP'
set key outside right top Left reverse
plot 'scan.csv' using 'angle_deg':'single' with lines title 'single scattering', \
     'scan.csv' using 'angle_deg':'black' with lines title 'exact, black ground', \
     'scan.csv' using 'angle_deg':'albedo_0.1' with lines title 'albedo 0.1', \
     'scan.csv' using 'angle_deg':'albedo_0.2' with lines title 'albedo 0.2', \
     'aerosol.csv' using 'angle_deg':'aerosol' with lines title 'aerosol 0.01', \
     'aerosol.csv' using 'angle_deg':'spheroids' with lines title 'spheroids 0.01', \
     'aerosol.csv' using 'angle_deg':'both' with lines title 'albedo 0.2 and aerosol'
