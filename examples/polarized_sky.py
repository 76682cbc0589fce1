"""A polarised sky in five lines: radiance, degree and angle of polarisation, the sun 60 degrees from the zenith."""
import malus

sky = malus.sky(wavelength_nm=450, sun_zenith_deg=60, albedo=0.1, dome_step_deg=2)
print(f"At most {float(malus.dolp(sky.radiance).max()):.0%} of the light is polarised.")
sky.malus.plot().savefig("polarized_sky.png", dpi=150)
