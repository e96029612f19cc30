"""One message in the formats that describe a bus: WHEELS, 0x100, two speeds of 16 bits.

Little endian, 0.005 rad/s a step; WhlFL begins at bit 0, WhlFR at bit 16. Written by hand.
"""

DBC = """VERSION ""
NS_ :
BS_:
BU_: ESP
BO_ 256 WHEELS: 8 ESP
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

SYM = """FormatVersion=6.0 // Do not edit this line!
Title="chassis"

{SENDRECEIVE}

[WHEELS]
ID=100h
Len=8
Var=WhlFL unsigned 0,16 /u:rad/s /f:0.005
Var=WhlFR unsigned 16,16 /u:rad/s /f:0.005
"""

_SIGNAL = """<I-SIGNAL><SHORT-NAME>{name}</SHORT-NAME><LENGTH>16</LENGTH>
  <SYSTEM-SIGNAL-REF DEST="SYSTEM-SIGNAL">/System/{name}</SYSTEM-SIGNAL-REF></I-SIGNAL>"""
_SYSTEM = """<SYSTEM-SIGNAL><SHORT-NAME>{name}</SHORT-NAME><PHYSICAL-PROPS>
  <SW-DATA-DEF-PROPS-VARIANTS><SW-DATA-DEF-PROPS-CONDITIONAL>
  <COMPU-METHOD-REF DEST="COMPU-METHOD">/Method/Speed</COMPU-METHOD-REF>
  <UNIT-REF DEST="UNIT">/Unit/Speed</UNIT-REF>
  </SW-DATA-DEF-PROPS-CONDITIONAL></SW-DATA-DEF-PROPS-VARIANTS></PHYSICAL-PROPS></SYSTEM-SIGNAL>"""
_MAPPING = """<I-SIGNAL-TO-I-PDU-MAPPING><SHORT-NAME>{name}</SHORT-NAME>
  <I-SIGNAL-REF DEST="I-SIGNAL">/Signal/{name}</I-SIGNAL-REF>
  <PACKING-BYTE-ORDER>MOST-SIGNIFICANT-BYTE-LAST</PACKING-BYTE-ORDER>
  <START-POSITION>{start}</START-POSITION></I-SIGNAL-TO-I-PDU-MAPPING>"""


def _package(name: str, elements: str) -> str:
    return f"""<AR-PACKAGE><SHORT-NAME>{name}</SHORT-NAME>
  <ELEMENTS>{elements}</ELEMENTS></AR-PACKAGE>"""


def _each(form: str) -> str:
    names = (("WhlFL", 0), ("WhlFR", 16))
    return "\n".join(form.format(name=name, start=start) for name, start in names)


ARXML = f"""<?xml version="1.0" encoding="UTF-8"?>
<AUTOSAR xmlns="http://autosar.org/schema/r4.0"
  xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
  xsi:schemaLocation="http://autosar.org/schema/r4.0 AUTOSAR_00046.xsd"><AR-PACKAGES>
{
    _package(
        "Cluster",
        '''<CAN-CLUSTER><SHORT-NAME>chassis</SHORT-NAME><CAN-CLUSTER-VARIANTS>
  <CAN-CLUSTER-CONDITIONAL><PHYSICAL-CHANNELS><CAN-PHYSICAL-CHANNEL>
  <SHORT-NAME>C</SHORT-NAME><FRAME-TRIGGERINGS><CAN-FRAME-TRIGGERING>
  <SHORT-NAME>WHEELS</SHORT-NAME><FRAME-REF DEST="CAN-FRAME">/Frame/WHEELS</FRAME-REF>
  <CAN-ADDRESSING-MODE>STANDARD</CAN-ADDRESSING-MODE><IDENTIFIER>256</IDENTIFIER>
  </CAN-FRAME-TRIGGERING></FRAME-TRIGGERINGS></CAN-PHYSICAL-CHANNEL></PHYSICAL-CHANNELS>
  </CAN-CLUSTER-CONDITIONAL></CAN-CLUSTER-VARIANTS></CAN-CLUSTER>''',
    )
}
{
    _package(
        "Frame",
        '''<CAN-FRAME><SHORT-NAME>WHEELS</SHORT-NAME><FRAME-LENGTH>8</FRAME-LENGTH>
  <PDU-TO-FRAME-MAPPINGS><PDU-TO-FRAME-MAPPING><SHORT-NAME>WHEELS</SHORT-NAME>
  <PDU-REF DEST="I-SIGNAL-I-PDU">/Pdu/WHEELS</PDU-REF></PDU-TO-FRAME-MAPPING>
  </PDU-TO-FRAME-MAPPINGS></CAN-FRAME>''',
    )
}
{_package("Signal", _each(_SIGNAL))}
{
    _package(
        "Pdu",
        f'''<I-SIGNAL-I-PDU><SHORT-NAME>WHEELS</SHORT-NAME><LENGTH>8</LENGTH>
  <I-SIGNAL-TO-PDU-MAPPINGS>{_each(_MAPPING)}</I-SIGNAL-TO-PDU-MAPPINGS></I-SIGNAL-I-PDU>''',
    )
}
{
    _package(
        "Method",
        '''<COMPU-METHOD><SHORT-NAME>Speed</SHORT-NAME><CATEGORY>LINEAR</CATEGORY>
  <UNIT-REF DEST="UNIT">/Unit/Speed</UNIT-REF>
  <COMPU-INTERNAL-TO-PHYS><COMPU-SCALES><COMPU-SCALE><COMPU-RATIONAL-COEFFS>
  <COMPU-NUMERATOR><V>0</V><V>0.005</V></COMPU-NUMERATOR>
  <COMPU-DENOMINATOR><V>1</V></COMPU-DENOMINATOR></COMPU-RATIONAL-COEFFS></COMPU-SCALE>
  </COMPU-SCALES></COMPU-INTERNAL-TO-PHYS></COMPU-METHOD>''',
    )
}
{
    _package(
        "Unit",
        '''<UNIT><SHORT-NAME>Speed</SHORT-NAME>
  <DISPLAY-NAME>rad/s</DISPLAY-NAME></UNIT>''',
    )
}
{_package("System", _each(_SYSTEM))}
</AR-PACKAGES></AUTOSAR>
"""
DATABASES = {"dbc": DBC, "kcd": KCD, "sym": SYM, "arxml": ARXML}
