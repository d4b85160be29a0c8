/* Bad input of every kind: each gives one message with its place, the key, what is wrong and what is allowed. */
#include "deasim/scene.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "scene_files.h"

/* In `file`, the first `old` becomes `new`; reading the scene then says `message` (its first line). */
static const struct bad_input {
    const char *file, *old, *new, *message;
} bad_inputs[] = {
    {"device.yaml", "width: 30 mm", "width: 30",
     "device.yaml:2:10: geometry.width: 30 m is outside 1 um .. 1 m; is the unit missing?"},
    {"device.yaml", "width: 30 mm", "width: 30 mV",
     "device.yaml:2:10: geometry.width: unit 'mV' is not that of a length; allowed: um, mm, m"},
    {"device.yaml", "width: 30 mm", "width: 30 MM",
     "device.yaml:2:10: geometry.width: unknown unit 'MM'; did you mean 'mm'? allowed: um, mm, m"},
    {"device.yaml", "width: 30 mm", "width: 30 M",
     "device.yaml:2:10: geometry.width: 'M' alone is not a unit (a SPICE suffix is not read here); allowed: um, mm, m"},
    {"device.yaml", "thickness: 33 um", "thickness: 33",
     "device.yaml:3:14: geometry.thickness: 33 m is outside 10 nm .. 10 mm; is the unit missing?"},
    {"device.yaml", "thickness: 33 um", "thickness: 33 F",
     "device.yaml:3:14: geometry.thickness: unit 'F' is not that of a length; allowed: um, mm, m"},
    {"material.yaml", "mu: 0.365 MPa", "mu: 0.365",
     "material.yaml:1:26: elastic.mu: 0.365 Pa is outside 100 Pa .. 1 GPa; is the unit missing?"},
    {"material.yaml", "mu: 0.365 MPa", "mu: 0.365 mPa",
     "material.yaml:1:26: elastic.mu: 365 uPa is outside 100 Pa .. 1 GPa"},
    {"material.yaml", "mu: 0.365 MPa", "mu: 0.365 MV",
     "material.yaml:1:26: elastic.mu: unit 'MV' is not that of a pressure; allowed: Pa, kPa, MPa, N/mm^2"},
    {"material.yaml", "breakdown: 100 V/um", "breakdown: 100",
     "material.yaml:4:44: dielectric.breakdown: 100 V/m is outside 100 kV/m .. 100 GV/m; is the unit missing?"},
    {"material.yaml", "breakdown: 100 V/um", "breakdown: 100 V",
     "material.yaml:4:44: dielectric.breakdown: unit 'V' is not that of an electric field; allowed: V/um, MV/m, kV/mm, "
     "V/m"},
    {"material.yaml", "tau: 2 ms", "tau: 2 Hz",
     "material.yaml:3:36: branches.0.tau: unit 'Hz' is not that of a time; allowed: ns, us, ms, s, min, h"},
    {"material.yaml", "tau: 2 ms", "tau: 2 mS",
     "material.yaml:3:36: branches.0.tau: unit 'mS' is not that of a time; allowed: ns, us, ms, s, min, h"},
    {"material.yaml", "permittivity: 2.5", "permittivity: 2.5 F/m",
     "material.yaml:4:28: dielectric.permittivity: unit 'F/m' is not that of a number; allowed: no unit, or %"},
    {"device.yaml", "mass: 0.428 g", "mass: 428",
     "device.yaml:9:18: platform.mass: 428 kg is outside 0 or 1 ng .. 1 kg; is the unit missing?"},
    {"device.yaml", "damping: 0 N s/m", "damping: 0.1 Ns/m",
     "device.yaml:9:36: platform.damping: unknown unit 'Ns/m'; did you mean 'N s/m'? allowed: N s/m, mN s/m, kg/s"},
    {"scene.yaml", "resistance: 1 MOhm", "resistance: 1 Meg",
     "scene.yaml:4:59: drive.left.resistance: 'Meg' alone is not a unit (a SPICE suffix is not read here); allowed: "
     "Ohm, kOhm, MOhm, GOhm"},
    {"scene.yaml", "resistance: 1 MOhm", "resistance: 1 M",
     "scene.yaml:4:59: drive.left.resistance: 'M' alone is not a unit (a SPICE suffix is not read here); allowed: Ohm, "
     "kOhm, MOhm, GOhm"},
    {"scene.yaml", "level: 3300 V", "level: 3,3 kV",
     "scene.yaml:4:40: drive.left.waveform: unknown key '3 kV' (a decimal comma? use a point); allowed: type, level"},
    {"scene.yaml", "level: 3300 V", "level: 3 300 V",
     "scene.yaml:4:38: drive.left.waveform.level: unknown unit '300 V'; allowed: mV, V, kV"},
    {"scene.yaml", "level: 3300 V", "level: 3300 kV",
     "scene.yaml:4:38: drive.left.waveform.level: 3.3 MV is outside -100 kV .. 100 kV"},
    {"scene.yaml", "sample: 0.1 ms", "sample: 0.1 kHz",
     "scene.yaml:7:18: output.sample: unit 'kHz' is not that of a time; allowed: ns, us, ms, s, min, h"},
    {"scene.yaml", "above: 0.40 mm", "above: 0.40 V",
     "scene.yaml:9:38: expect.0.above: unit 'V' is not that of a length; allowed: um, mm, m"},
    {"device.yaml", "width: 30 mm", "width: -30 mm",
     "device.yaml:2:10: geometry.width: -30 mm is not positive; allowed: 1 um .. 1 m"},
    {"device.yaml", "width: 30 mm", "width: 0 mm",
     "device.yaml:2:10: geometry.width: 0 m is not positive; allowed: 1 um .. 1 m"},
    {"device.yaml", "left: {length: 4 mm", "left: {length: 0",
     "device.yaml:7:18: zones.left.length: 0 m is not positive; allowed: 1 um .. 1 m"},
    {"device.yaml", "right: {length: 4 mm", "right: {length: -4 mm",
     "device.yaml:8:19: zones.right.length: -4 mm is not positive; allowed: 1 um .. 1 m"},
    {"device.yaml", "thickness: 33 um", "thickness: .nan",
     "device.yaml:3:14: geometry.thickness: '.nan' is not a number with a unit"},
    {"device.yaml", "thickness: 33 um", "thickness: nan",
     "device.yaml:3:14: geometry.thickness: 'nan' is not a finite number"},
    {"device.yaml", "thickness: 33 um", "thickness: inf um",
     "device.yaml:3:14: geometry.thickness: 'inf um' is not a finite number"},
    {"device.yaml", "thickness: 33 um", "thickness: 1e999 um",
     "device.yaml:3:14: geometry.thickness: '1e999 um' is too large a number"},
    {"device.yaml", "thickness: 33 um", "thickness: 0x21 um",
     "device.yaml:3:14: geometry.thickness: '0x21 um' is not a number with a unit"},
    {"material.yaml", "tau: 2 ms", "tau: 0 ms",
     "material.yaml:3:36: branches.0.tau: 0 s is not positive; allowed: 1 ns .. 1e+08 s"},
    {"material.yaml", "tau: 2 ms", "tau: -2 ms",
     "material.yaml:3:36: branches.0.tau: -2 ms is not positive; allowed: 1 ns .. 1e+08 s"},
    {"material.yaml", "mu: 0.365 MPa", "mu: 0 Pa",
     "material.yaml:1:26: elastic.mu: 0 Pa is not positive; allowed: 100 Pa .. 1 GPa"},
    {"material.yaml", "mu: 29.2 kPa", "mu: -29.2 kPa",
     "material.yaml:3:21: branches.0.mu: -29.2 kPa is not positive; allowed: 10 Pa .. 1 GPa"},
    {"material.yaml", "jm: 16.6", "jm: 0",
     "material.yaml:1:41: elastic.jm: 0 is not positive; allowed: 0.001 .. 1e+09"},
    {"material.yaml", "permittivity: 2.5", "permittivity: 0",
     "material.yaml:4:28: dielectric.permittivity: 0 is not positive; allowed: 0.1 .. 1e+05"},
    {"material.yaml", "permittivity: 2.5", "permittivity: 2.5, permittivity_slope: -2.5",
     "material.yaml:4:13: dielectric: the permittivity at the prestretch 1.2 is -0.5; it must be positive "
     "(permittivity + permittivity_slope lam1)"},
    {"material.yaml", "conductivity: 0 S/m", "conductivity: -1 S/m",
     "material.yaml:4:68: dielectric.conductivity: -1 S/m is negative; allowed: 0 or 1e-25 S/m .. 1 S/m"},
    {"material.yaml", "density: 1120 kg/m^3", "density: 1.12",
     "material.yaml:5:10: density: 1.12 kg/m^3 is outside 10 kg/m^3 .. 3e+04 kg/m^3; is the unit missing?"},
    {"device.yaml", "mass: 0.428 g", "mass: -0.428 g",
     "device.yaml:9:18: platform.mass: -428 mg is negative; allowed: 0 or 1 ng .. 1 kg"},
    {"device.yaml", "prestretch: [1.2, 1.2]", "prestretch: [1.2, 0]",
     "device.yaml:4:21: geometry.prestretch.1: 0 is not positive; allowed: 0.05 .. 20"},
    {"scene.yaml", "stop: 400 ms", "stop: 0",
     "scene.yaml:5:19: transient.stop: 0 s is not positive; allowed: 1 ns .. 1e+08 s"},
    {"scene.yaml", "stop: 400 ms", "stop: -1 s",
     "scene.yaml:5:19: transient.stop: -1 s is not positive; allowed: 1 ns .. 1e+08 s"},
    {"scene.yaml", "accuracy: 1e-4", "accuracy: 0",
     "scene.yaml:5:37: transient.accuracy: 0 is not positive; allowed: 1e-12 .. 0.1"},
    {"scene.yaml", "accuracy: 1e-4", "accuracy: 0.5",
     "scene.yaml:5:37: transient.accuracy: 0.5 is outside 1e-12 .. 0.1"},
    {"scene.yaml", "accuracy: 1e-4", "accuracy: 1e-13",
     "scene.yaml:5:37: transient.accuracy: 1e-13 is outside 1e-12 .. 0.1"},
    {"scene.yaml", "resistance: 1 MOhm", "resistance: -1 MOhm",
     "scene.yaml:4:59: drive.left.resistance: -1 MOhm is negative; allowed: 0 or 1 mOhm .. 1 TOhm"},
    {"device.yaml", "prestretch: [1.2, 1.2]", "prestrech: [1.2, 1.2]",
     "device.yaml:4:3: geometry: unknown key 'prestrech'; did you mean 'prestretch'? allowed: width, thickness, "
     "prestretch"},
    {"device.yaml", "  prestretch: [1.2, 1.2]\n", "",
     "device.yaml:2:3: geometry: the key 'prestretch' of a geometry is missing"},
    {"device.yaml", "width: 30 mm", "width: 30 mm\n  width: 40 mm",
     "device.yaml:3:3: duplicate key 'width'; already given on line 2"},
    {"device.yaml", "platform: {mass", "platform: {weight",
     "device.yaml:9:12: platform: unknown key 'weight'; allowed: mass, damping, load, stops, stop_stiffness, "
     "stop_loss"},
    {"device.yaml", "material: material.yaml\n", "", "device.yaml:1:1: the key 'material' of a device is missing"},
    {"scene.yaml", "title: Test", "titel: Test",
     "scene.yaml:1:1: unknown key 'titel'; did you mean 'title'? allowed: title, device, devices, drive, load, "
     "transient, initial, events, output, expect"},
    {"scene.yaml", "device: device.yaml\n", "",
     "scene.yaml:1:1: the key 'device' of a scene is missing (or 'devices' for several)"},
    {"scene.yaml", "device: device.yaml", "device: device.yaml\ndevices: {A: device.yaml}",
     "scene.yaml:3:10: devices: give either device or devices, not both"},
    {"scene.yaml", "drive:\n  left: {waveform: {type: dc, level: 3300 V}, resistance: 1 MOhm}\n", "",
     "scene.yaml:1:1: the key 'drive' of a scene is missing (drive: {} grounds every electrode)"},
    {"scene.yaml", "transient: {stop: 400 ms, accuracy: 1e-4}\n", "",
     "scene.yaml:1:1: the key 'transient' is missing (only a netlist can give it by .tran)"},
    {"scene.yaml", "stop: 400 ms, ", "",
     "scene.yaml:5:12: transient: the key 'stop' is missing (only a netlist can give it by .tran)"},
    {"scene.yaml", "slack: warn", "slak: warn",
     "scene.yaml:6:27: events: unknown key 'slak'; did you mean 'slack'? allowed: breakdown, slack, stress2, limit, "
     "stability, stop"},
    {"material.yaml", "law: gent", "law: gnet",
     "material.yaml:1:16: elastic.law: unknown choice 'gnet'; did you mean 'gent'? allowed: gent, neo_hookean, yeoh, "
     "ogden, arruda_boyce"},
    {"material.yaml", "law: gent, ", "", "material.yaml:1:10: elastic: the key 'law' of an elastic law is missing"},
    {"material.yaml", "law: gent", "law: yeoh",
     "material.yaml:1:22: elastic: unknown key 'mu'; allowed: law, c10, c20, c30"},
    {"material.yaml", "law: gent, mu: 0.365 MPa, jm: 16.6", "law: ogden, terms: []",
     "material.yaml:1:30: elastic.terms: 0 Ogden terms; allowed: 1 to 6"},
    {"material.yaml", "law: gent, mu: 0.365 MPa, jm: 16.6", "law: ogden, terms: [{mu: 1 MPa, alpha: -2}]",
     "material.yaml:1:30: elastic.terms: the shear modulus, the sum of mu alpha / 2, is -1e+06 Pa; it must be "
     "positive"},
    {"material.yaml", "law: gent, mu: 0.365 MPa, jm: 16.6", "law: arruda_boyce, mu: 15 kPa, locking_stretch: 1",
     "material.yaml:1:59: elastic.locking_stretch: 1 is outside 1.001 .. 1000"},
    {"material.yaml", "kind: foo", "kind: network, jm: 20",
     "material.yaml:3:25: branches.0.jm: a network branch has no jm; leave it out, or use kind: foo"},
    {"material.yaml", "kind: foo, ", "", "material.yaml:3:5: branches.0: the key 'kind' of a branch is missing"},
    {"device.yaml", "width: 30 mm", "width: [30 mm]",
     "device.yaml:2:10: geometry.width: expected a length, found a list"},
    {"device.yaml", "width: 30 mm", "width: {value: 30 mm, unit: mm}",
     "device.yaml:2:25: geometry.width: unknown key 'unit'; allowed: value"},
    {"device.yaml", "width: 30 mm", "width: {value: [1], source: x}",
     "device.yaml:2:18: geometry.width.value: expected a length, found a list"},
    {"device.yaml", "width: 30 mm",
     "width:", "device.yaml:2:9: geometry.width: has no value; give one or leave the key out"},
    {"device.yaml", "width: 30 mm", "width: wide",
     "device.yaml:2:10: geometry.width: 'wide' is not a number with a unit"},
    {"device.yaml", "prestretch: [1.2, 1.2]", "prestretch: 1.2",
     "device.yaml:4:15: geometry.prestretch: expected a list of two, found '1.2'"},
    {"device.yaml", "prestretch: [1.2, 1.2]", "prestretch: [1.2, 1.2, 1.2]",
     "device.yaml:4:15: geometry.prestretch: expected a list of two, found 3 entries"},
    {"device.yaml", "membrane_mass: true", "membrane_mass: maybe",
     "device.yaml:10:26: options.membrane_mass: expected true or false, found 'maybe'"},
    {"device.yaml", "electrode: {resistance: 0 Ohm}", "electrode: true",
     "device.yaml:7:35: zones.left.electrode: expected an electrode as a mapping, found 'true'; keys: resistance, "
     "sheet_resistance, feed"},
    {"device.yaml", "electrode: {resistance: 0 Ohm}", "electrode: {feed: narrow_end}",
     "device.yaml:7:42: zones.left.electrode.feed: feed has no effect without a sheet_resistance"},
    {"device.yaml", "electrode: {resistance: 0 Ohm}", "electrode: {sheet_resistance: 50 kOhm/sq, feed: narrow}",
     "device.yaml:7:72: zones.left.electrode.feed: expected one of the allowed words, found 'narrow'; allowed: "
     "long_edge, narrow_end"},
    {"device.yaml", "stops: [-3 mm, 3 mm]", "stops: [3 mm, -3 mm]",
     "device.yaml:9:63: platform.stops: the stops must lie on both sides of x = 0, the lower one first"},
    {"device.yaml", "stops: [-3 mm, 3 mm]", "stop_loss: 1 s/m",
     "device.yaml:9:67: platform.stop_loss: has no effect without stops"},
    {"device.yaml", "  left: {length: 4 mm, electrode: {resistance: 0 Ohm}}\n  right: {length: 4 mm}", "  notes: none",
     "device.yaml:7:3: zones: a device needs at least one zone; allowed: left, right"},
    {"device.yaml", "zones:", "zones: []\nzone:",
     "device.yaml:7:1: unknown key 'zone'; did you mean 'zones'? allowed: name, geometry, material, zones, platform, "
     "options"},
    {"material.yaml", "branches:\n  - {kind: foo, mu: 29.2 kPa, tau: 2 ms}", "branches: {kind: foo}",
     "material.yaml:2:11: branches: expected a list of branches, found a mapping"},
    {"scene.yaml", "title: Test", "title: [a]", "scene.yaml:1:8: title: expected a text, found a list"},
    {"scene.yaml", "title: Test", "title: \"a\\nb\"",
     "scene.yaml:1:8: title: a line break or control character is not allowed in this text"},
    {"scene.yaml", "drive:\n  left: {waveform: {type: dc, level: 3300 V}, resistance: 1 MOhm}", "drive: 3300 V",
     "scene.yaml:3:8: drive: expected a drive as a mapping, found '3300 V'; keys: netlist, left, right"},
    {"scene.yaml",
     "  left:", "  right:", "scene.yaml:4:10: drive.right: the right zone is passive: it has no electrode to drive"},
    {"scene.yaml",
     "  left:", "  centre:", "scene.yaml:4:3: drive: unknown key 'centre'; allowed: netlist, left, right"},
    {"scene.yaml", "drive:\n", "drive:\n  netlist: drive.cir\n",
     "scene.yaml:5:9: drive.left: a native source besides a netlist; give one or the other"},
    {"scene.yaml", "  left: {waveform: {type: dc, level: 3300 V}, resistance: 1 MOhm}", "  netlist: missing.cir",
     "scene.yaml:4:12: drive.netlist: cannot read missing.cir: No such file or directory"},
    {"scene.yaml", "  left: {waveform: {type: dc, level: 3300 V}, resistance: 1 MOhm}", "  netlist: .",
     "scene.yaml:4:12: drive.netlist: cannot read .: it is a directory"},
    {"scene.yaml", ", resistance: 1 MOhm", ", amplifier: {current_limit: 1 mA}",
     "scene.yaml:4:58: drive.left.amplifier: an amplifier needs a resistance in series: give output_resistance, the "
     "source's resistance or the electrode's"},
    {"scene.yaml", ", resistance: 1 MOhm", ", amplifier: {slew_rate: 0 V/us}",
     "scene.yaml:4:70: drive.left.amplifier.slew_rate: 0 V/s is not positive; allowed: 1 mV/s .. 1 TV/s"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{level: 3300 V}",
     "scene.yaml:4:20: drive.left.waveform: the key 'type' of a waveform is missing; allowed: dc, pulse, pwl, sine, "
     "chirp, trapezoid, file"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: square, level: 3300 V}",
     "scene.yaml:4:27: drive.left.waveform.type: expected one of the allowed words, found 'square'; allowed: dc, "
     "pulse, pwl, sine, chirp, trapezoid, file"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: dc, high: 3300 V}",
     "scene.yaml:4:31: drive.left.waveform: unknown key 'high'; allowed: type, level"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "3300 V",
     "scene.yaml:4:20: drive.left.waveform: expected a waveform as a mapping, found '3300 V'; keys: type, level"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: pulse, high: 1 kV, period: 1 s}",
     "scene.yaml:4:20: drive.left.waveform: the key 'width' of a pulse with a period is missing"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: pulse, high: 1 kV, width: 2 s, period: 1 s}",
     "scene.yaml:4:20: drive.left.waveform: pulse: period 1 s is shorter than rise + width + fall = 2 s"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: pulse, high: 1 kV, rise: -1 ms}",
     "scene.yaml:4:52: drive.left.waveform.rise: -1 ms is negative; allowed: 0 or 1 ps .. 1e+08 s"},
    {"scene.yaml", "{type: dc, level: 3300 V}",
     "{type: trapezoid, high: 1 kV, rise: 1 ms, flat: 1 ms, fall: 1 ms, gap: 1 ms, period: 4 ms}",
     "scene.yaml:4:105: drive.left.waveform.period: give either period or gap, not both"},
    {"scene.yaml", "{type: dc, level: 3300 V}",
     "{type: trapezoid, high: 1 kV, rise: 1 ms, flat: 1 ms, fall: 1 ms, period: 2 ms}",
     "scene.yaml:4:94: drive.left.waveform.period: the period 0.002 s is shorter than rise + flat + fall = 0.003 s"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: sine, amplitude: 1 kV, frequency: 10 ms}",
     "scene.yaml:4:61: drive.left.waveform.frequency: unit 'ms' is not that of a frequency; allowed: mHz, Hz, kHz, "
     "MHz"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: sine, amplitude: 1 kV}",
     "scene.yaml:4:20: drive.left.waveform: the key 'frequency' of a sine waveform is missing"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: chirp, amplitude: 1 kV, from: 1 Hz, to: 100 Hz, duration: 0 s}",
     "scene.yaml:4:85: drive.left.waveform.duration: 0 s is not positive; allowed: 1 ps .. 1e+08 s"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: pwl, points: []}",
     "scene.yaml:4:40: drive.left.waveform.points: 0 points [time, value]; allowed: 1 to 1000000"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: pwl, points: [[0, 0], [1 ms]]}",
     "scene.yaml:4:49: drive.left.waveform.points.1: expected a list of two, found 1 entry"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: pwl, points: [[0, 0], [2 ms, 1 kV], [1 ms, 0]]}",
     "scene.yaml:4:63: drive.left.waveform.points.2: time 0.001 s goes back behind 0.002 s of the point before"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: pwl, points: [[0, 0], [1 ms, 1 ms]]}",
     "scene.yaml:4:56: drive.left.waveform.points.1.1: unit 'ms' is not that of a voltage; allowed: mV, V, kV"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: file, path: missing.csv}",
     "scene.yaml:4:39: drive.left.waveform.path: missing.csv: cannot be opened: No such file or directory"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: file, path: gap.csv}",
     "scene.yaml:4:39: drive.left.waveform.path: gap.csv:3: the value is missing"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: file, path: back.csv}",
     "scene.yaml:4:39: drive.left.waveform.path: back.csv:4: time of point 3, 0.001 s, goes back behind 0.002 s"},
    {"scene.yaml", "{type: dc, level: 3300 V}", "{type: file, path: unitless.csv}",
     "scene.yaml:4:39: drive.left.waveform.path: unitless.csv:1: column 'time' lacks its unit; write it as \"name "
     "[unit]\""},
    {"scene.yaml", "title: Test", "load: {type: dc, level: 1 V}",
     "scene.yaml:1:25: load.level: unit 'V' is not that of a force; allowed: uN, mN, N"},
    {"scene.yaml", "breakdown: stop", "breakdown: explode",
     "scene.yaml:6:21: events.breakdown: expected one of the allowed words, found 'explode'; allowed: ignore, warn, "
     "stop, short"},
    {"scene.yaml", "slack: warn", "slack: short",
     "scene.yaml:6:34: events.slack: only breakdown can be a short; allowed: ignore, warn, stop"},
    {"scene.yaml", "title: Test", "initial: frsh",
     "scene.yaml:1:10: initial: unknown choice 'frsh'; did you mean 'fresh'? allowed: equilibrium, fresh"},
    {"scene.yaml", "title: Test", "initial: {x: 5}",
     "scene.yaml:1:14: initial.x: 5 m is outside -1 m .. 1 m; is the unit missing?"},
    {"scene.yaml", "formats: [csv, raw]", "formats: [csv, xls]",
     "scene.yaml:7:41: output.formats.1: expected one of the allowed words, found 'xls'; allowed: csv, raw, hdf5"},
    {"scene.yaml", "formats: [csv, raw]", "formats: csv",
     "scene.yaml:7:35: output.formats: expected a list of formats, found 'csv'"},
    {"scene.yaml", "formats: [csv, raw]", "signals: [x, right.voltage]",
     "scene.yaml:7:39: output.signals.1: the scene has no signal 'right.voltage'; did you mean 'left.voltage'? "
     "allowed: x, v, left.voltage, left.port_voltage, left.charge, left.current, left.capacitance, left.true_field, "
     "left.stretch, left.tension, left.stress2, right.stretch, right.tension, right.stress2, energy.in, energy.stored, "
     "energy.dissipated, energy.imbalance"},
    {"scene.yaml", "formats: [csv, raw]", "signals: [x, x]",
     "scene.yaml:7:39: output.signals.1: signal 'x' is already in the list"},
    {"scene.yaml", "sample: 0.1 ms", "sample: 1 s",
     "scene.yaml:7:18: output.sample: the sample time 1 s is longer than the run, 0.4 s"},
    {"scene.yaml", "sample: 0.1 ms", "sample: 1 ps",
     "scene.yaml:7:18: output.sample: the run would write 4e+11 rows; at most 1e+08 are allowed"},
    {"scene.yaml", "signal: x", "signal: left.voltag",
     "scene.yaml:9:14: expect.0.signal: the scene has no signal 'left.voltag'; did you mean 'left.voltage'? allowed: "
     "x, v, left.voltage, left.port_voltage, left.charge, left.current, left.capacitance, left.true_field, "
     "left.stretch, left.tension, left.stress2, right.stretch, right.tension, right.stress2, energy.in, energy.stored, "
     "energy.dissipated, energy.imbalance"},
    {"scene.yaml", "signal: x", "signal: quux_nothing",
     "scene.yaml:9:14: expect.0.signal: the scene has no signal 'quux_nothing'; allowed: x, v, left.voltage, "
     "left.port_voltage, left.charge, left.current, left.capacitance, left.true_field, left.stretch, left.tension, "
     "left.stress2, right.stretch, right.tension, right.stress2, energy.in, energy.stored, energy.dissipated, "
     "energy.imbalance"},
    {"scene.yaml", "signal: x, ", "", "scene.yaml:9:15: expect.0.measure: measure 'max' needs the key 'signal'"},
    {"scene.yaml", "signal: x, measure: max", "measure: rise_time",
     "scene.yaml:9:15: expect.0.measure: without a netlist there is no .measure 'rise_time'; give a signal"},
    {"scene.yaml", "measure: max", "measure: maximum",
     "scene.yaml:9:26: expect.0.measure: expected one of the allowed words, found 'maximum'; allowed: min, max, final, "
     "t_max"},
    {"scene.yaml", "measure: max, ", "", "scene.yaml:9:5: expect.0: the key 'measure' of an expectation is missing"},
    {"scene.yaml", ", above: 0.40 mm, below: 0.46 mm", "",
     "scene.yaml:9:5: expect.0: an expectation needs a bound: above, below or both"},
    {"scene.yaml", "above: 0.40 mm", "above: 0.50 mm",
     "scene.yaml:9:38: expect.0.above: nothing lies above 0.0005 and below 0.00046"},
    {"scene.yaml", "device: device.yaml", "device: nowhere.yaml",
     "scene.yaml:2:9: device: cannot read nowhere.yaml: No such file or directory"},
    {"scene.yaml", "device: device.yaml", "device: .", "scene.yaml:2:9: device: cannot read .: it is a directory"},
    {"scene.yaml", "device: device.yaml", "device: empty.yaml",
     "scene.yaml:2:9: device: cannot read empty.yaml: it is empty"},
    {"scene.yaml", "device: device.yaml", "device: comment.yaml", "comment.yaml: holds no keys"},
    {"scene.yaml", "device: device.yaml", "device: garbage.yaml",
     "garbage.yaml: not a YAML text file: control characters are not allowed (byte 0)"},
    {"scene.yaml", "device: device.yaml", "device: list.yaml", "list.yaml:1:1: expected 'key: value' lines"},
    {"scene.yaml", "device: device.yaml", "device: text.yaml",
     "text.yaml:1:1: expected 'key: value' lines; is the space after a ':' missing?"},
    {"scene.yaml", "device: device.yaml", "device: [device.yaml]",
     "scene.yaml:2:9: device: expected a device as a mapping, found a list; keys: name, geometry, material, zones, "
     "platform, options"},
    {"scene.yaml", "device: device.yaml", "device: a.yaml",
     "b.yaml:1:7: base: circular reference: scene.yaml -> a.yaml -> b.yaml -> a.yaml"},
    {"scene.yaml", "device: device.yaml", "device: self.yaml",
     "self.yaml:1:7: base: circular reference: scene.yaml -> self.yaml -> self.yaml"},
    {"scene.yaml", "device: device.yaml", "device: scene.yaml",
     "scene.yaml:2:9: device: circular reference: scene.yaml -> scene.yaml"},
    {"device.yaml", "material: material.yaml", "material: device.yaml",
     "device.yaml:5:11: material: circular reference: scene.yaml -> device.yaml -> device.yaml"},
    {"material.yaml", "density: 1120 kg/m^3", "density: 1120 kg/m^3\nbase: material.yaml",
     "material.yaml:6:7: base: circular reference: scene.yaml -> device.yaml -> material.yaml -> material.yaml"},
    {"device.yaml", "  width: 30 mm", "\twidth: 30 mm",
     "device.yaml:2:1: not valid YAML: while scanning for the next token from line 2, found character that cannot "
     "start any token (a tab? indent with spaces)"},
    {"device.yaml", "width: 30 mm", "width: 30: mm",
     "device.yaml:2:12: not valid YAML: mapping values are not allowed in this context"},
    {"device.yaml", "prestretch: [1.2, 1.2]", "prestretch: [1.2, 1.2",
     "device.yaml:5:9: not valid YAML: while parsing a flow sequence from line 4, did not find expected ',' or ']'"},
    {"device.yaml", "width: 30 mm", "width: *w", "device.yaml:2:10: alias '*w' has no anchor '&w' before it"},
    {"device.yaml", "prestretch: [1.2, 1.2]", "prestretch: &p [1.2, *p]",
     "device.yaml:4:24: alias '*p' stands inside its own anchor: circular"},
    {"device.yaml", "width: 30 mm", "width: !!float 30", "device.yaml:2:10: YAML tags ('!...') have no meaning here"},
    {"device.yaml", "width: 30 mm", "? [a]\n  : 30 mm", "device.yaml:2:5: a key must be plain text"},
    {"device.yaml", "options: {membrane_mass: true, slack: true}", "---\noptions: {}",
     "device.yaml:10:1: a second YAML document ('---'); only one is read"},
    {"two.yaml", "drive: {netlist: drive.cir}", "drive: {}\ntransient: {stop: 1 s}",
     "two.yaml:2:8: drive: several devices need a netlist; native sources drive a single device"},
    {"two.yaml", "DEB: device.yaml", "dea: device.yaml",
     "two.yaml:1:29: devices: 'DEA' and 'dea' are the same name in a netlist"},
    {"two.yaml", "DEB: device.yaml", "2B: device.yaml",
     "two.yaml:1:29: devices: '2B' cannot name a subcircuit; allowed: a letter, then letters, digits and _, at most "
     "31"},
    {"two.yaml", "{DEA: device.yaml, DEB: device.yaml}", "{}", "two.yaml:1:10: devices: 0 devices; allowed: 1 to 64"},
    {"two.yaml", "{DEA: device.yaml, DEB: device.yaml}", "[device.yaml]",
     "two.yaml:1:10: devices: expected a mapping of names to devices, found a list"},
    {"two.yaml", "drive: {netlist: drive.cir}", "drive: {netlist: drive.cir}\nload: {type: dc, level: 1 N}",
     "two.yaml:3:7: load: a load waveform needs a single device"},
    {"two.yaml", "drive: {netlist: drive.cir}",
     "drive: {netlist: drive.cir}\nexpect: [{signal: x, measure: max, above: 1 mm}]",
     "two.yaml:3:19: expect.0.signal: the scene has no signal 'x'; allowed: DEA.x, DEA.v, DEA.left.voltage, "
     "DEA.left.port_voltage, DEA.left.charge, DEA.left.current, DEA.left.capacitance, DEA.left.true_field, "
     "DEA.left.stretch, DEA.left.tension, DEA.left.stress2, DEA.right.stretch, DEA.right.tension, DEA.right.stress2, "
     "DEA.energy.in, DEA.energy.stored, DEA.energy.dissipated, DEA.energy.imbalance, DEB.x, DEB.v, DEB.left.voltage, "
     "DEB.left.port_voltage, DEB.left.charge, DEB.left.current, DEB.left.capacitance, DEB.left.true_field, "
     "DEB.left.stretch, DEB.left.tension, DEB.left.stress2, DEB.right.stretch, DEB.right.tension, DEB.right.stress2, "
     "DEB.energy.in, DEB.energy.stored, DEB.energy.dissipated"},
};

static void change_file(const struct bad_input *bad) {
    const char *text = original_text(bad->file), *place = strstr(text, bad->old);
    char changed[4096];
    assert_non_null(place);
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(place - text), text, bad->new, place + strlen(bad->old));
    write_text(bad->file, changed);
}

static void refuses_bad_input(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof bad_inputs / sizeof bad_inputs[0]; i++) {
        const struct bad_input *bad = &bad_inputs[i];
        struct dea_scene scene;
        struct dea_error error = {0};
        change_file(bad);
        const char *path = strcmp(bad->file, "two.yaml") == 0 ? "two.yaml" : "scene.yaml";
        enum dea_status status = dea_scene_read(path, NULL, 0, &scene, &error);
        dea_scene_clear(&scene);
        write_text(bad->file, original_text(bad->file));
        error.text[strcspn(error.text, "\n")] = '\0';
        if (status != DEA_ERR_INPUT || strcmp(error.text, bad->message) != 0)
            fail_msg("%s: '%s' -> '%s': status %d\n got      %s\n expected %s", bad->file, bad->old, bad->new,
                     (int)status, error.text, bad->message);
    }
}

static void refuses_a_missing_scene(void **state) {
    (void)state;
    static const struct {
        const char *path, *message;
    } cases[] = {
        {"nowhere.yaml", "cannot read nowhere.yaml: No such file or directory"},
        {".", "cannot read .: it is a directory"},
        {"empty.yaml", "cannot read empty.yaml: it is empty"},
        {"garbage.yaml", "garbage.yaml: not a YAML text file: control characters are not allowed (byte 0)"},
        {"/dev/zero", "cannot read /dev/zero: it is not a regular file"},
        {"", "cannot read : No such file or directory"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct dea_scene scene;
        struct dea_device device;
        struct dea_error error = {0};
        assert_int_equal(dea_scene_read(cases[i].path, NULL, 0, &scene, &error), DEA_ERR_INPUT);
        dea_scene_clear(&scene);
        assert_string_equal(error.text, cases[i].message);
        assert_int_equal(dea_device_read(cases[i].path, NULL, 0, &device, &error), DEA_ERR_INPUT);
        dea_device_clear(&device);
        assert_string_equal(error.text, cases[i].message);
    }
}

static void shows_the_line_and_a_caret(void **state) {
    (void)state;
    struct dea_device device;
    struct dea_error error = {0};
    write_text("caret.yaml", "geometry:\n  width: 30\n");
    assert_int_equal(dea_device_read("caret.yaml", NULL, 0, &device, &error), DEA_ERR_INPUT);
    assert_non_null(strstr(error.text, "caret.yaml:1:1: the key 'material' of a device is missing"));
    write_text("caret.yaml", "material: material.yaml\nzones: {left: {length: 4 mm}}\n"
                             "geometry: {thickness: 33 \u00b5m, width: 30, prestretch: [1, 1]}\n");
    assert_int_equal(dea_device_read("caret.yaml", NULL, 0, &device, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text,
                        "caret.yaml:3:37: geometry.width: 30 m is outside 1 um .. 1 m; is the unit missing?\n"
                        "    3 | geometry: {thickness: 33 \u00b5m, width: 30, prestretch: [1, 1]}\n"
                        "      |                                     ^");
    dea_device_clear(&device);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refuses_bad_input),
        cmocka_unit_test(refuses_a_missing_scene),
        cmocka_unit_test(shows_the_line_and_a_caret),
    };
    return cmocka_run_group_tests(tests, enter_scene_folder, leave_scene_folder);
}
