"""One message as DBC and KCD: WHEELS, 0x100, two speeds of 16 bits; SYM and ARXML of others.

Little endian, 0.005 rad/s a step; WhlFL begins at bit 0, WhlFR at bit 16. Written by hand.
"""

from pathlib import Path

DBC_HEAD = 'VERSION ""\nNS_ :\nBS_:\nBU_: ESP\n'
DBC = f"""{DBC_HEAD}BO_ 256 WHEELS: 8 ESP
 SG_ WhlFL : 0|16@1+ (0.005,0) [0|327] "rad/s" ESP
 SG_ WhlFR : 16|16@1+ (0.005,0) [0|327] "rad/s" ESP
"""

KCD = """<NetworkDefinition xmlns="http://kayak.2codeornot2code.org/1.0">
  <Document name="chassis"/>
  <Bus name="chassis">
    <Message id="0x100" name="WHEELS" length="8">
      <Signal name="WhlFL" offset="0" length="16"><Value slope="0.005" unit="rad/s"/></Signal>
      <Signal name="WhlFR" offset="16" length="16"><Value slope="0.005" unit="rad/s"/></Signal>
    </Message>
  </Bus>
</NetworkDefinition>
"""

SAMPLES = Path(__file__).parents[1] / "logs" / "bus" / "samples"

DATABASES = {
    "dbc": DBC,
    "kcd": KCD,
    "sym": (SAMPLES / "comments_hex_and_motorola.sym").read_text(),
    "arxml": (SAMPLES / "compu_method_no_category.arxml").read_text(),
}
