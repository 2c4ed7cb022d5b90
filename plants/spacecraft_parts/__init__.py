"""What a spacecraft is made of: hub with wheels and thrusters, hinged appendages, the loads of its surroundings."""
