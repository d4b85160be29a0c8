/* The list of scenes. */
#include "coupled_scenes.h"

#include "coupled_cases.h"

static const struct coupled_scene scenes[] = {
    {"r_0", "device: {" TWO_ZONES "}",
     "t\nVs left 0 PWL(0 0 1m 0 1.01m 2500)\nRr right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n", 0.02, ""},
    {"r_1e-3", "device: {" TWO_ZONES "}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nRs s left 1e-3\nRr right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n", 0.02,
     ""},
    {"r_1", "device: {" TWO_ZONES "}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nRs s left 1\nRr right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n", 0.02, ""},
    {"r_1e3", "device: {" TWO_ZONES "}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nRs s left 1e3\nRr right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n", 0.02, ""},
    {"r_1e5", "device: {" TWO_ZONES "}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nRs s left 1e5\nRr right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n", 0.02, ""},
    {"r_1e7", "device: {" TWO_ZONES "}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nRs s left 1e7\nRr right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n", 0.02, ""},
    {"r_1e9", "device: {" TWO_ZONES "}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nRs s left 1e9\nRr right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n", 0.02, ""},
    {"r_1e10", "device: {" TWO_ZONES "}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nRs s left 1e10\nRr right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n", 0.02,
     ""},
    {"r_1e12", "device: {" TWO_ZONES "}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nRs s left 1e12\nRr right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n", 0.02,
     ""},
    {"pitch_7000_el", "device: {" ELASTIC ", options: {slack: false}}",
     "t\nVl sl 0 PWL(0 7000 1m 7000 1.1m 6500)\nRl sl left 1meg\nVr sr 0 7000\nRr sr right 1meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.02, ""},
    {"pitch_7000_visc", "device: {" TWO_ZONES ", options: {slack: false}}",
     "t\nVl sl 0 PWL(0 7000 1m 7000 1.1m 6500)\nRl sl left 1meg\nVr sr 0 7000\nRr sr right 1meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.02, ""},
    {"pitch_7000_nomass",
     "device: {" ELASTIC ", options: {membrane_mass: false, slack: false}, platform: {mass: 0 kg}}",
     "t\nVl sl 0 PWL(0 7000 1m 7000 1.1m 6500)\nRl sl left 1meg\nVr sr 0 7000\nRr sr right 1meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.02, ""},
    {"pitch_7200_el", "device: {" ELASTIC ", options: {slack: false}}",
     "t\nVl sl 0 PWL(0 7200 1m 7200 1.1m 6700)\nRl sl left 1meg\nVr sr 0 7200\nRr sr right 1meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.02, ""},
    {"pitch_7200_visc", "device: {" TWO_ZONES ", options: {slack: false}}",
     "t\nVl sl 0 PWL(0 7200 1m 7200 1.1m 6700)\nRl sl left 1meg\nVr sr 0 7200\nRr sr right 1meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.02, ""},
    {"pitch_7200_nomass",
     "device: {" ELASTIC ", options: {membrane_mass: false, slack: false}, platform: {mass: 0 kg}}",
     "t\nVl sl 0 PWL(0 7200 1m 7200 1.1m 6700)\nRl sl left 1meg\nVr sr 0 7200\nRr sr right 1meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.02, ""},
    {"pitch_7350_el", "device: {" ELASTIC ", options: {slack: false}}",
     "t\nVl sl 0 PWL(0 7350 1m 7350 1.1m 6850)\nRl sl left 1meg\nVr sr 0 7350\nRr sr right 1meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.02, ""},
    {"pitch_7350_visc", "device: {" TWO_ZONES ", options: {slack: false}}",
     "t\nVl sl 0 PWL(0 7350 1m 7350 1.1m 6850)\nRl sl left 1meg\nVr sr 0 7350\nRr sr right 1meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.02, ""},
    {"pitch_7350_nomass",
     "device: {" ELASTIC ", options: {membrane_mass: false, slack: false}, platform: {mass: 0 kg}}",
     "t\nVl sl 0 PWL(0 7350 1m 7350 1.1m 6850)\nRl sl left 1meg\nVr sr 0 7350\nRr sr right 1meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.02, ""},
    {"pitch_7400_el", "device: {" ELASTIC ", options: {slack: false}}",
     "t\nVl sl 0 PWL(0 7400 1m 7400 1.1m 6900)\nRl sl left 1meg\nVr sr 0 7400\nRr sr right 1meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.02, ""},
    {"pitch_7400_visc", "device: {" TWO_ZONES ", options: {slack: false}}",
     "t\nVl sl 0 PWL(0 7400 1m 7400 1.1m 6900)\nRl sl left 1meg\nVr sr 0 7400\nRr sr right 1meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.02, ""},
    {"pitch_7400_nomass",
     "device: {" ELASTIC ", options: {membrane_mass: false, slack: false}, platform: {mass: 0 kg}}",
     "t\nVl sl 0 PWL(0 7400 1m 7400 1.1m 6900)\nRl sl left 1meg\nVr sr 0 7400\nRr sr right 1meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.02, ""},
    {"slack_both_visc", "device: {" TWO_ZONES "}",
     "t\nVl sl 0 PWL(0 7000 1m 7000 1.1m 7010)\nRl sl left 1meg\nVr sr 0 7000\nRr sr right 1meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.02, ""},
    {"floating", "device: {" TWO_ZONES "}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nRs s left 1meg\nCf right 0 200p\nRf right 0 1e12\nXdea left right right 0 "
     "pos DEA\n.end\n",
     0.02, ""},
    {"float_node_shunt", "device: {" TWO_ZONES "}",
     "t\n.options rshunt=1e13\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nRs s left 1meg\nRr r 0 1k\nXdea left 0 right r pos "
     "DEA\n.end\n",
     0.02, ""},
    {"off_ground", "device: {" TWO_ZONES "}",
     "t\nVa a 0 PWL(0 3000 1m 3000 1.1m 5000)\nVb b 0 PWL(0 3000 2m 3000 2.1m 2000)\nRa a left 1meg\nRb b lb 2meg\nVc "
     "c 0 -1000\nRc c right 1meg\nXdea left lb right b pos DEA\n.end\n",
     0.02, ""},
    {"feedback", "device: {" TWO_ZONES "}",
     "t\nBs s 0 V=3000*(time>1m ? 1 : 0)-3000*v(pos)\nRs s left 1meg\nRr right 0 1meg\nXdea left 0 right 0 pos "
     "DEA\n.end\n",
     0.03, ""},
    {"feedback_linear", "device: {" TWO_ZONES "}",
     "t\nVs0 s0 0 PWL(0 0 1m 0 1.1m 3000)\nEs s 0 VOL='v(s0)-2000*v(pos)'\nRs s left 1meg\nRr right 0 1meg\nXdea left "
     "0 right 0 pos DEA\n.end\n",
     0.03, ""},
    {"uic", "device: {" TWO_ZONES "}",
     "t\nVs s 0 2000\nRs s left 10meg\nRr right 0 1meg\nC1 left 0 100p\n.ic v(left)=1500\nXdea left 0 right 0 pos "
     "DEA\n.tran 10u 20m uic\n.end\n",
     0, ""},
    {"uic_plain", "device: {" TWO_ZONES "}",
     "t\nVs s 0 2000\nRs s left 10meg\nRr right 0 1meg\nXdea left 0 right 0 pos DEA\n.tran 10u 20m uic\n.end\n", 0, ""},
    {"ic_op", "device: {" TWO_ZONES "}",
     "t\nVs s 0 2000\nRs s left 10meg\nRr right 0 1meg\nC1 left 0 100p\n.ic v(left)=1500\nXdea left 0 right 0 pos "
     "DEA\n.end\n",
     0.02, ""},
    {"bias", "device: {" TWO_ZONES "}",
     "t\nVs s 0 PWL(0 3000 1m 3000 1.1m 1000)\nRs s left 10meg\nVr r 0 2000\nRr r right 1meg\nXdea left 0 right 0 pos "
     "DEA\n.end\n",
     0.02, ""},
    {"bias_leak",
     "device: {" TWO_ZONES ", material: {base: " SOURCE_ROOT
     "/models/materials/sylgard186.yaml, dielectric: {conductivity: 1e-9 S/m}}}",
     "t\nVs s 0 PWL(0 3000 1m 3000 1.1m 1000)\nRs s left 100meg\nVr r 0 2000\nRr r right 100meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.04, ""},
    {"bias_exp",
     "device: {" TWO_ZONES ", material: {base: " SOURCE_ROOT
     "/models/materials/sylgard186.yaml, dielectric: {conductivity: 3e-9 S/m, conductivity_field: 40 V/um}}}",
     "t\nVs s 0 PWL(0 3000 1m 3000 1.1m 1000)\nRs s left 100meg\nVr r 0 2000\nRr r right 100meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.04, ""},
    {"bias_exp_strong",
     "device: {" TWO_ZONES ", material: {base: " SOURCE_ROOT
     "/models/materials/sylgard186.yaml, dielectric: {conductivity: 1e-9 S/m, conductivity_field: 10 V/um}}}",
     "t\nVs s 0 PWL(0 3000 1m 3000 1.1m 1000)\nRs s left 1000meg\nVr r 0 2000\nRr r right 100meg\nXdea left 0 right 0 "
     "pos DEA\n.end\n",
     0.04, ""},
    {"slack_active", "device: {" ELASTIC ", geometry: {prestretch: [1.05, 1.2]}}",
     "t\nVs s 0 PWL(0 0 1m 0 1.1m 3800 6m 3800 6.1m 0)\nRs s left 1meg\nRr right 0 1meg\nXdea left 0 right 0 pos "
     "DEA\n.end\n",
     0.02, ""},
    {"slack_passive", "device: {" ELASTIC ", geometry: {prestretch: [1.02, 1.2]}, zones: {right: {electrode: null}}}",
     "t\nVs s 0 PWL(0 0 1m 0 1.1m 3300 6m 3300 6.1m 0)\nRs s left 1meg\nXdea left 0 pos DEA\n.end\n", 0.02, ""},
    {"slack_static",
     "device: {" ELASTIC ", geometry: {prestretch: [1.02, 1.2]}, options: {membrane_mass: false}, platform: {mass: 0 "
     "kg, damping: 0.05 N s/m}}",
     "t\nVs s 0 PWL(0 0 1m 0 3m 4000 6m 4000 8m 0)\nRs s left 1meg\nRr right 0 1meg\nXdea left 0 right 0 pos "
     "DEA\n.end\n",
     0.012, ""},
    {"slack_fast_charge", "device: {" ELASTIC ", geometry: {prestretch: [1.05, 1.2]}}",
     "t\nVs s 0 PWL(0 0 1m 0 1.001m 6000 6m 6000 6.001m 0)\nRs s left 10k\nRr right 0 10k\nXdea left 0 right 0 pos "
     "DEA\n.end\n",
     0.015, ""},
    {"two_devices", "devices: {DEA: {" TWO_ZONES "}, DEB: {" ELASTIC ", platform: {mass: 1 g}}}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nRs s a 1meg\nRm a b 2meg\nRr r 0 1k\nXone a 0 r 0 posa DEA\nXtwo b 0 r 0 "
     "posb DEB\n.end\n",
     0.02, ""},
    {"twice", "device: {" TWO_ZONES "}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nRs s a 1meg\nRm a b 2meg\nRr r 0 1k\nXone a 0 r 0 posa DEA\nXtwo b 0 r 0 "
     "posb DEA\n.end\n",
     0.02, ""},
    {"sub", "device: {" TWO_ZONES "}",
     "t\n.subckt arm in out\nR1 in e 1meg\nR2 q 0 1meg\nXd e 0 q 0 out DEA\n.ends\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nXl "
     "s pa arm\nXr s pb arm\n.end\n",
     0.02, ""},
    {"passive", "device: {base: " SOURCE_ROOT "/models/planar_unidirectional.yaml}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 3300)\nRs s left 1meg\nXdea left 0 pos DEA\n.end\n", 0.03, ""},
    {"sheet", "device: {base: " SOURCE_ROOT "/models/planar_carbon_electrodes.yaml}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 3300)\nRs s left 1k\nRr right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n", 0.02, ""},
    {"series_zones", "device: {" TWO_ZONES "}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 4000)\nRs s a 1meg\nRb b 0 1g\nXdea a b b 0 pos DEA\n.end\n", 0.02, ""},
    {"sine_pol", "device: {" ELASTIC ", " NO_MASS "}",
     "t\nVs s 0 SIN(0 3000 100)\nRs s left 1meg\nRr right 0 1meg\nXdea left 0 right 0 pos DEA\n.end\n", 0.02, ""},
    {"diode", "device: {" TWO_ZONES "}",
     "t\nVs s 0 SIN(0 3000 500)\nD1 s r dm\nRs r left 100k\nRr right 0 1meg\nRl left 0 1g\n.model dm D(IS=1e-12 N=1.8 "
     "RS=10 CJO=2p TT=50n)\nXdea left 0 right 0 pos DEA\n.end\n",
     0.02, ""},
    {"vm_jump", "device: {" ELASTIC ", options: {membrane_mass: false}, platform: {mass: 0 kg, damping: 0.2 N s/m}}",
     "t\nVs s 0 PWL(0 0 1m 0 1.0001m 3300)\nRs s left 1k\nRr right 0 1meg\nXdea left 0 right 0 pos DEA\n.end\n", 0.01,
     ""},
    {"nm_jump", "device: {" ELASTIC ", " NO_MASS "}",
     "t\nVs s 0 PWL(0 0 1m 0 1.0001m 3300)\nRs s left 1k\nRr right 0 1meg\nXdea left 0 right 0 pos DEA\n.end\n", 0.005,
     ""},
    {"nm_r0", "device: {" ELASTIC ", " NO_MASS "}",
     "t\nVs left 0 PWL(0 0 1m 0 1.0001m 3300)\nXdea left 0 right 0 pos DEA\nRr right 0 1\n.end\n", 0.005, ""},
    {"fresh", "device: {" TWO_ZONES "}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nRs s left 1meg\nRr right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n", 0.02,
     "initial: fresh"},
    {"ini_x", "device: {" TWO_ZONES "}",
     "t\nVs s 0 1000\nRs s left 1meg\nRr right 0 1k\nXdea left 0 right 0 pos DEA\n.end\n", 0.02,
     "initial: {x: 0.2 mm, v: 0.1 m/s}"},
    {"right_first",
     "device: {geometry: {width: 30 mm, thickness: 33 um, prestretch: [1.2, 1.2]}, material: " SOURCE_ROOT
     "/models/materials/sylgard186.yaml, zones: {right: {length: 4 mm, electrode: {resistance: 0 Ohm}}, left: {length: "
     "4 mm, electrode: {resistance: 0 Ohm}}}, platform: {mass: 0.428 g}}",
     "t\nVs s 0 PWL(0 0 1m 0 1.01m 2500)\nRs s e 1meg\nRr r 0 1k\nXdea e 0 r 0 pos DEA\n.end\n", 0.02, ""},
};

const struct coupled_scene *list_scenes(size_t *count) {
    *count = sizeof scenes / sizeof scenes[0];
    return scenes;
}
